#include "paper/report_document.h"

#include <html/inline_svg.h>
#include <html/page.h>
#include <io/errors.h>
#include <io/input_file.h>

#include <ostream>
#include <utility>

namespace bayesian_icp::evaluate {

namespace {

constexpr std::uint64_t max_figure_size = 1 << 26;

/** Each block as HTML; figures are numbered through the whole page. */
class BlockWriter {
public:
  explicit BlockWriter(std::string folder) : folder_(std::move(folder)) {}

  std::string
  operator()(const ReportText& block)
  {
    return html::paragraphHtml(block.text);
  }

  std::string
  operator()(const ReportCode& block)
  {
    return html::codeHtml(block.text);
  }

  std::string
  operator()(const ReportTable& table)
  {
    return html::tableHtml({table.caption, table.header, table.rows});
  }

  std::string
  operator()(const ReportFigure& figure)
  {
    const std::string file = folder_ + "/" + figure.file + ".svg";
    const std::string document = io::readText(file, max_figure_size);
    if (document.find("<svg") == std::string::npos ||
        document.rfind("</svg>") == std::string::npos)
      throw io::FileError(file, "is not a complete SVG file");
    const std::string id = "figure-" + std::to_string(++num_figures_);
    return html::figureHtml(html::inlineSvg(document, id, figure.file, figure.caption),
                            figure.caption,
                            html::FigureWidth::Scrolled);
  }

private:
  std::string folder_;
  int num_figures_ = 0;
};

} // namespace

void
writeHtml(const ReportDocument& document,
          const std::string& folder,
          std::ostream& stream)
{
  BlockWriter writer(folder);
  std::string body;
  int num_sections = 0;
  for (const ReportSection& section : document.sections) {
    std::string content;
    for (const ReportBlock& block : section.blocks)
      content += std::visit(writer, block);
    const std::string id = "section-" + std::to_string(++num_sections);
    body += html::sectionHtml(id, section.title, content);
  }
  stream << html::pageHtml(document.title, body);
}

} // namespace bayesian_icp::evaluate
