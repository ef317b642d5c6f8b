#include "html/page.h"

#include <boost/locale/utf.hpp>

namespace bayesian_icp::html {

namespace {

/** The style sheet of all pages. */
const char* const style = R"css(
:root { color-scheme: light dark; --text: #1c1f23; --page: #ffffff; --faint: #5b6570;
  --line: #d5dade; --panel: #f5f7f9; --good: #00694c; --caution: #8a5a00; --bad: #a8321e; }
@media screen and (prefers-color-scheme: dark) {
  :root { --text: #e6e9ec; --page: #15181c; --faint: #a3adb7; --line: #3a424a;
    --panel: #1e2328; --good: #4fd1a5; --caution: #f0b84a; --bad: #ff8f78; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--text);
  font: 1rem/1.5 system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif; }
main { max-width: 68rem; margin: 0 auto; padding: 1rem; overflow-wrap: anywhere; }
h1 { font-size: 1.4rem; line-height: 1.25; margin: .5rem 0 1rem; }
h2 { font-size: 1.15rem; margin: 2.2rem 0 .5rem; padding-top: .6rem;
  border-top: 1px solid var(--line); }
p, ul { max-width: 46rem; margin: .5rem 0; }
ul { padding-left: 1.3rem; }
.box { border: 1px solid var(--line); border-left: .4rem solid; border-radius: .4rem;
  background: var(--panel); padding: .7rem 1rem; margin: .8rem 0; }
.box p { font-size: 1.08rem; max-width: none; }
.box .tone { font-size: 1.2rem; }
.good { border-left-color: var(--good); } .good .tone { color: var(--good); }
.caution { border-left-color: var(--caution); } .caution .tone { color: var(--caution); }
.bad { border-left-color: var(--bad); } .bad .tone { color: var(--bad); }
.scroll { overflow-x: auto; max-width: 100%; overflow-wrap: normal; }
table { border-collapse: collapse; font-size: .92rem; font-variant-numeric: tabular-nums;
  margin: .4rem 0; }
caption { text-align: left; color: var(--faint); padding-bottom: .3rem; }
th, td { padding: .25rem .7rem .25rem 0; border-bottom: 1px solid var(--line);
  text-align: right; white-space: nowrap; vertical-align: top; }
th { text-align: left; font-weight: 600; } th.number { text-align: right; }
td.words { text-align: left; }
td.words:last-child { white-space: normal; min-width: 13rem; }
caption span { display: inline-block; max-width: calc(100vw - 2rem); white-space: normal; }
pre { background: var(--panel); border: 1px solid var(--line); border-radius: .4rem;
  padding: .7rem; margin: .5rem 0; white-space: pre-wrap; overflow-wrap: anywhere;
  font-size: .85rem; }
.grid { display: grid; gap: .6rem 1.2rem;
  grid-template-columns: repeat(auto-fill, minmax(min(100%, 19rem), 1fr)); }
.pairs { grid-template-columns: repeat(auto-fill, minmax(min(100%, 24rem), 1fr)); }
.legend { list-style: none; padding: 0; display: flex; flex-wrap: wrap; gap: .2rem 1rem;
  font-size: .9rem; }
.swatch { display: inline-block; width: .8rem; height: .8rem; border-radius: 50%;
  margin-right: .4rem; print-color-adjust: exact; -webkit-print-color-adjust: exact; }
figure { margin: .6rem 0; min-width: 0; }
figcaption { color: var(--faint); font-size: .9rem; max-width: 46rem; }
figure svg { display: block; width: 100%; height: auto; }
figure .scroll svg { min-width: 40rem; }
details { margin: .6rem 0; } summary { cursor: pointer; font-weight: 600; }
@media print { body { font-size: 10pt; } main { max-width: none; padding: 0; }
  figure, table, .box, pre { break-inside: avoid; } h2 { break-after: avoid; }
  .scroll { overflow: visible; } figure .scroll svg { min-width: 0; }
  .grid { grid-template-columns: repeat(3, 1fr); }
  td, th { white-space: normal; }
  ::details-content { content-visibility: visible; block-size: auto; } }
)css";

const char* const replacement_character = "\xEF\xBF\xBD";

std::string
escapedCharacter(char character)
{
  switch (character) {
  case '&':
    return "&amp;";
  case '<':
    return "&lt;";
  case '>':
    return "&gt;";
  case '"':
    return "&quot;";
  case '\'':
    return "&#39;";
  case '\t':
  case '\n':
    return std::string(1, character);
  default:
    const bool is_control =
        static_cast<unsigned char>(character) < 0x20 || character == 0x7F;
    return is_control ? replacement_character : std::string(1, character);
  }
}

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
escaped(std::string_view text)
{
  namespace utf = boost::locale::utf;
  std::string result;
  const char* const end = text.data() + text.size();
  for (const char* begin = text.data(); begin != end;) {
    const char* next = begin;
    const utf::code_point code = utf::utf_traits<char>::decode(next, end);
    if (!utf::is_valid_codepoint(code)) {
      result += replacement_character;
      next = begin + 1;
    }
    else if (next == begin + 1)
      result += escapedCharacter(*begin);
    else
      result.append(begin, next);
    begin = next;
  }
  return result;
}

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
