#include "html/page.h"

#include "html/escape.h"
#include "html/style.h"

namespace bayesian_icp::html {

namespace {

std::string
element(const std::string& tag, const std::string& content_html)
{
  return '<' + tag + '>' + content_html + "</" + tag.substr(0, tag.find(' ')) + '>';
}

/** What is too wide for a phone scrolls by itself, also by keyboard. */
std::string
scrolledHtml(const std::string& label, const std::string& content_html)
{
  return element("div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"" +
                     escaped(label) + '"',
                 content_html);
}

std::string
rowHtml(const Table& table, const std::vector<std::string>& cells)
{
  std::string html;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool is_words = i >= table.first_column_of_words;
    html += element(i == 0     ? "th scope=\"row\""
                    : is_words ? "td class=\"words\""
                               : "td",
                    escaped(cells[i]));
  }
  return element("tr", html) + '\n';
}

} // namespace

std::string
tableHtml(const Table& table)
{
  std::string header, rows;
  for (std::size_t i = 0; i < table.header.size(); ++i)
    header += element(i > 0 && i < table.first_column_of_words
                          ? "th scope=\"col\" class=\"number\""
                          : "th scope=\"col\"",
                      escaped(table.header[i]));
  for (const auto& cells : table.rows)
    rows += rowHtml(table, cells);
  return scrolledHtml(
             table.caption,
             element("table",
                     element("caption", element("span", escaped(table.caption))) +
                         element("thead", element("tr", header)) +
                         element("tbody", rows))) +
         '\n';
}

std::string
limitedTableHtml(Table table, std::size_t max_rows, const std::string& more)
{
  const std::size_t num_rows = table.rows.size();
  if (num_rows > max_rows)
    table.rows.resize(max_rows);
  return num_rows == 0
             ? ""
             : tableHtml(table) +
                   paragraphHtml(num_rows > max_rows
                                     ? std::to_string(num_rows - max_rows) + ' ' + more
                                     : "");
}

std::string
paragraphHtml(const std::string& text)
{
  return text.empty() ? "" : element("p", escaped(text)) + '\n';
}

std::string
listHtml(const std::vector<std::string>& items)
{
  std::string html;
  for (const std::string& item : items)
    html += element("li", escaped(item));
  return html.empty() ? "" : element("ul", html) + '\n';
}

std::string
codeHtml(const std::string& text)
{
  return element("pre", element("code", escaped(text))) + '\n';
}

std::string
figureHtml(const std::string& svg_html, const std::string& caption, FigureWidth width)
{
  const char* name = width == FigureWidth::Small ? "small" : "full";
  return element(std::string("figure class=\"") + name + '"',
                 (width == FigureWidth::Scrolled ? scrolledHtml(caption, svg_html)
                                                 : svg_html) +
                     element("figcaption", escaped(caption))) +
         '\n';
}

std::string
figureGridHtml(const std::string& figures_html, FigureGrid grid)
{
  return element(grid == FigureGrid::Any ? "div class=\"grid\""
                                         : "div class=\"grid pairs\"",
                 figures_html) +
         '\n';
}

std::string
legendHtml(const std::vector<std::pair<std::string, std::string>>& colours)
{
  std::string html;
  for (const auto& [colour, meaning] : colours)
    html += element("li",
                    "<span class=\"swatch\" style=\"background:" + escaped(colour) +
                        "\"></span>" + escaped(meaning));
  return element("ul class=\"legend\"", html) + '\n';
}

std::string
sectionHtml(const std::string& id,
            const std::string& heading,
            const std::string& content_html)
{
  return element("section id=\"" + id + '"',
                 element("h2", escaped(heading)) + '\n' + content_html) +
         '\n';
}

std::string
detailsHtml(const std::string& summary, const std::string& content_html)
{
  return element("details", element("summary", escaped(summary)) + content_html) + '\n';
}

std::string
boxHtml(Tone tone, const std::string& heading, const std::string& content_html)
{
  const char* name = tone == Tone::Good      ? "good"
                     : tone == Tone::Caution ? "caution"
                                             : "bad";
  const char* sign = tone == Tone::Good ? "✓" : tone == Tone::Caution ? "!" : "✗";
  return element(std::string("div class=\"box ") + name + '"',
                 "<strong class=\"tone\"><span aria-hidden=\"true\">" +
                     std::string(sign) + "</span> " + escaped(heading) + "</strong>\n" +
                     content_html) +
         '\n';
}

std::string
pageHtml(const std::string& title, const std::string& body_html)
{
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
         "style-src 'unsafe-inline'; img-src data:\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<meta name=\"color-scheme\" content=\"light dark\">\n"
         // Browsers ask for /favicon.ico otherwise.
         "<link rel=\"icon\" href=\"data:,\">\n<title>" +
         escaped(title) + "</title>\n<style>\n" + style +
         "</style>\n</head>\n<body>\n" +
         element("main", element("h1", escaped(title)) + '\n' + body_html) +
         "\n</body>\n</html>\n";
}

} // namespace bayesian_icp::html
