#include "report/report_html.h"

#include "html/inline_svg.h"
#include "register/report_text.h"
#include "report/verdict.h"

#include <filesystem>

namespace bayesian_icp::app {

namespace {

std::string
verdictHtml(const Run& run)
{
  const Verdict verdict = verdictOf(run.result.summary, run.settings.options.preset);
  return html::boxHtml(
             verdict.tone, verdict.heading, html::paragraphHtml(verdict.sentence)) +
         html::paragraphHtml(
             "The pose maps source points into the target frame; ± is one standard "
             "deviation. " +
             verdict.scale_note) +
         html::paragraphHtml("Status: " + statusText(run.result.summary));
}

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

std::string
titleOf(const Run& run)
{
  const auto nameOf = [](const io::CloudFile& cloud) {
    const std::filesystem::path path(cloud.file);
    return (path.parent_path().filename() / path.filename()).string();
  };
  return nameOf(run.source) + " registered to " + nameOf(run.target);
}

} // namespace

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

std::string
reportHtml(const Run& run, const std::string& command)
{
  return html::pageHtml(titleOf(run),
                        verdictHtml(run) + sectionsHtml(reportSections(run, command)));
}

} // namespace bayesian_icp::app
