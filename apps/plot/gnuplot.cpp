#include "plot/gnuplot.h"

#include "plot/child_program.h"

#include <boost/algorithm/string/replace.hpp>

#include <sstream>
#include <string_view>

namespace bayesian_icp::plot {

namespace {

/** The first line of gnuplot's complaints that says something. */
std::string
firstComplaint(const std::string& errors)
{
  std::istringstream lines(errors);
  std::string line;
  while (std::getline(lines, line))
    if (line.find_first_not_of(" ^\t") != std::string::npos &&
        line.find("warning") == std::string::npos)
      return ": " + line;
  return "";
}

std::string
scriptOf(const Drawing& drawing)
{
  return "reset session\nset encoding utf8\nset terminal svg noenhanced rounded size " +
         std::to_string(drawing.width) + ", " + std::to_string(drawing.height) +
         " font 'sans-serif,12'\nset output\n" + drawing.script + '\n';
}

constexpr std::string_view svg_end = "</svg>";

/** The documents that follow each other in \p text. One that is cut off is not among
 * them. */
std::vector<std::string>
documentsOf(const std::string& text)
{
  std::vector<std::string> documents;
  std::size_t begin = 0;
  while (true) {
    begin = text.find_first_not_of('\n', begin);
    const std::size_t last = text.find(svg_end, begin);
    if (last == std::string::npos)
      return documents;
    const std::size_t end = last + svg_end.size();
    documents.push_back(text.substr(begin, end - begin));
    begin = end;
  }
}

} // namespace

std::string
quotedForGnuplot(const std::string& text)
{
  return "'" + boost::replace_all_copy(text, "'", "''") + "'";
}

std::string
dataBlock(const std::string& name, const std::string& lines)
{
  return '$' + name + " << EOD\n" + lines + "EOD\n";
}

std::vector<std::string>
drawSvgs(const std::vector<Drawing>& drawings)
{
  std::string script;
  for (const Drawing& drawing : drawings)
    script += scriptOf(drawing);
  // Users' own settings of gnuplot are not for these pictures.
  const ProgramResult run =
      runChildProgram({"gnuplot", "--default-settings", "/dev/stdin"}, script);
  if (!run.is_good && !runChildProgram({"gnuplot", "--version"}, "").is_good)
    throw GnuplotError("is not installed, but figures need it (package gnuplot-nox)");
  if (!run.is_good)
    throw GnuplotError("could not draw the figures" + firstComplaint(run.errors));
  std::vector<std::string> svgs = documentsOf(run.output);
  if (svgs.size() != drawings.size())
    throw GnuplotError("has not drawn all figures");
  return svgs;
}

} // namespace bayesian_icp::plot
