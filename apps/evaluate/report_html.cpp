#include "report_document.h"

#include <io/errors.h>
#include <io/input_file.h>

#include <array>
#include <ostream>
#include <utility>

namespace bayesian_icp::evaluate {

namespace {

constexpr std::uint64_t max_figure_size = 1 << 26;

constexpr char style[] =
    "body{font:16px/1.5 sans-serif;max-width:75rem;margin:2rem auto;padding:0 1rem;"
    "color:#222;background:#fff}"
    "table{border-collapse:collapse;margin:.5rem 0 1.5rem;font-size:.85rem;"
    "font-variant-numeric:tabular-nums}"
    "caption{text-align:left;padding:.3rem 0}"
    "th,td{border:1px solid #bbb;padding:.15rem .5rem;text-align:right}"
    "th:first-child,td:first-child{text-align:left}"
    "thead th{background:#eee}figure{margin:1rem 0;overflow-x:auto}"
    "div{overflow-x:auto}pre{background:#f4f4f4;padding:.7rem;overflow-x:auto}"
    "svg{max-width:100%;height:auto}";

std::string
escaped(const std::string& text)
{
  std::string html;
  for (const char character : text)
    switch (character) {
    case '&':
      html += "&amp;";
      break;
    case '<':
      html += "&lt;";
      break;
    case '>':
      html += "&gt;";
      break;
    case '"':
      html += "&quot;";
      break;
    default:
      html += character;
    }
  return html;
}

void
replaceAll(const std::string& from, const std::string& to, std::string& text)
{
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

/** The <svg> element of a file, its identifiers made different from those of other
 * figures. */
std::string
inlineSvg(const std::string& file, const std::string& prefix)
{
  std::string svg = io::readText(file, max_figure_size);
  const std::size_t begin = svg.find("<svg"), end = svg.rfind("</svg>");
  if (begin == std::string::npos || end == std::string::npos)
    throw io::FileError(file, "is not a complete SVG file");
  svg = svg.substr(begin, end + 6 - begin);
  for (const char* place : {"id=\"", "id='", "href=\"#", "href='#", "url(#"})
    replaceAll(place, place + prefix, svg);
  return svg;
}

class HtmlWriter {
public:
  HtmlWriter(std::string folder, std::ostream& stream)
  : folder_(std::move(folder))
  , stream_(stream)
  {}

  void
  operator()(const ReportText& block)
  {
    stream_ << "<p>" << escaped(block.text) << "</p>\n";
  }

  void
  operator()(const ReportCode& block)
  {
    stream_ << "<pre>" << escaped(block.text) << "</pre>\n";
  }

  void
  operator()(const ReportTable& table)
  {
    stream_ << "<div><table>\n<caption>" << escaped(table.caption)
            << "</caption>\n<thead>";
    writeRow(table.header, "th");
    stream_ << "</thead>\n<tbody>\n";
    for (const auto& row : table.rows)
      writeRow(row, "td");
    stream_ << "</tbody></table></div>\n";
  }

  void
  operator()(const ReportFigure& figure)
  {
    const std::string prefix = "figure" + std::to_string(++num_figures_) + "-";
    stream_ << "<figure>\n"
            << inlineSvg(folder_ + "/" + figure.file + ".svg", prefix)
            << "\n<figcaption>" << escaped(figure.caption)
            << "</figcaption>\n</figure>\n";
  }

private:
  void
  writeRow(const std::vector<std::string>& cells, const std::string& element)
  {
    stream_ << "<tr>";
    for (const std::string& cell : cells)
      stream_ << '<' << element << '>' << escaped(cell) << "</" << element << '>';
    stream_ << "</tr>\n";
  }

  std::string folder_;
  std::ostream& stream_;
  int num_figures_ = 0;
};

} // namespace

void
writeHtml(const ReportDocument& document,
          const std::string& folder,
          std::ostream& stream)
{
  const std::string title = escaped(document.title);
  stream << "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
         << "<meta name=\"viewport\" content=\"width=device-width\">\n<title>" << title
         << "</title>\n<style>" << style << "</style></head>\n<body>\n<h1>" << title
         << "</h1>\n";
  HtmlWriter writer(folder, stream);
  for (const ReportSection& section : document.sections) {
    stream << "<h2>" << escaped(section.title) << "</h2>\n";
    for (const ReportBlock& block : section.blocks)
      std::visit(writer, block);
  }
  stream << "</body></html>\n";
}

} // namespace bayesian_icp::evaluate
