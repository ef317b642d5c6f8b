#include "html/page.h"

#include <boost/algorithm/string/replace.hpp>

namespace bayesian_icp::html {

namespace {

/** Takes out everything from each \p begin to the next \p end, both included. */
void
removeAll(std::string& text, const std::string& begin, const std::string& end)
{
  std::string kept;
  std::size_t position = 0;
  while (true) {
    const auto from = text.find(begin, position);
    const auto to =
        from == std::string::npos ? from : text.find(end, from + begin.size());
    if (to == std::string::npos)
      break;
    kept.append(text, position, from - position);
    position = to + end.size();
  }
  text = kept.append(text, position);
}

/** What is between the first \p begin and the next \p end; empty if they are not there.
 */
std::string
between(const std::string& text, const std::string& begin, const std::string& end)
{
  const auto from = text.find(begin);
  const auto to =
      from == std::string::npos ? from : text.find(end, from + begin.size());
  if (to == std::string::npos)
    return "";
  return text.substr(from + begin.size(), to - from - begin.size());
}

} // namespace

std::string
inlineSvg(const std::string& document,
          const std::string& id,
          const std::string& title,
          const std::string& description)
{
  std::string content = between(document, "<svg", "</svg>");
  content.erase(0, content.find('>') + 1);
  // Titles within are tooltips with gnuplot's commands.
  removeAll(content, "<title>", "</title>");
  removeAll(content, "<desc>", "</desc>");
  removeAll(content, " id=\"gnuplot_", "\"");
  const bool has_markers =
      content.find("href='#gp") < content.rfind("</defs>") &&
      content.find("href='#gp", content.rfind("</defs>")) != std::string::npos;
  if (!has_markers)
    removeAll(content, "<defs>", "</defs>");
  const std::string own = id + '-';
  for (const std::string name : {"gpDot", "gpPt", "textbox", "greybox"})
    for (const std::string before : {"id='", "'#", "url(#"})
      boost::replace_all(
          content, before + name, std::string(before).append(own).append(name));
  boost::replace_all(content, " color=\"black\"", "");
  boost::replace_all(content, "\"black\"", "\"currentColor\"");
  boost::replace_all(content, "'black'", "'currentColor'");
  boost::replace_all(content, "\n\n", "\n");
  return "<svg id=\"" + id + "\" viewBox=\"" + between(document, "viewBox=\"", "\"") +
         "\" role=\"img\" aria-labelledby=\"" + id + "-title " + id +
         "-description\"><title id=\"" + id + "-title\">" + escaped(title) +
         "</title><desc id=\"" + id + "-description\">" + escaped(description) +
         "</desc>" + content + "</svg>";
}

} // namespace bayesian_icp::html
