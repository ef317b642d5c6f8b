#include "report/section.h"

#include "io/program.h"

#include <filesystem>

namespace bayesian_icp::app {

namespace {

/** Takes the pictures of the section's charts, in their order, from \p svgs. */
std::string
sectionHtml(const Section& section, std::vector<std::string>::const_iterator& svgs)
{
  std::string figures, wide_figures;
  for (const Chart& chart : section.charts) {
    const std::string figure = html::figureHtml(
        html::inlineSvg(*svgs++, chart.id, chart.title, chart.description),
        chart.caption,
        chart.width);
    (chart.width == html::FigureWidth::Small ? figures : wide_figures) += figure;
  }
  return html::sectionHtml(
      section.id,
      section.heading,
      section.above_html +
          (figures.empty() ? "" : html::figureGridHtml(figures, section.grid)) +
          wide_figures + section.below_html);
}

} // namespace

std::string
commandHtml(const std::string& command, const std::string& note)
{
  std::error_code ignored;
  return html::paragraphHtml("In the folder " +
                             std::filesystem::current_path(ignored).string() + note +
                             ':') +
         html::codeHtml(command);
}

std::string
sectionsHtml(const std::vector<Section>& sections)
{
  std::vector<plot::Drawing> drawings;
  for (const Section& section : sections)
    for (const Chart& chart : section.charts)
      drawings.push_back(chart.drawing);
  const std::vector<std::string> svgs = plot::drawSvgs(drawings);
  auto next_svg = svgs.begin();
  std::string body;
  for (const Section& section : sections)
    body += sectionHtml(section, next_svg);
  return body;
}

void
addReport(const std::function<std::string()>& make, io::OutputFolder& folder)
{
  const std::string name = "report.html";
  try {
    folder.add(name, make());
  }
  catch (const plot::GnuplotError& error) {
    io::tell(name + " is not written: " + error.what());
    folder.leaveOut(name);
  }
}

} // namespace bayesian_icp::app
