#include "report/sections.h"

#include "io/numbers.h"
#include "register/settings_json.h"
#include "report/charts.h"
#include "report/tables.h"

#include <nlohmann/json.hpp>

#include <filesystem>

namespace bayesian_icp::app {

namespace {

/** More chains than this have no legend. */
constexpr std::size_t max_chains_in_legend = 12;

std::string
drawsText(const Summary& summary)
{
  return "Draws: " + io::textOf(summary.num_draws) +
         ", chains: " + io::textOf(summary.num_chains - summary.num_diverged_chains) +
         '.';
}

Section
poseSection(const Run& run)
{
  const Summary& summary = run.result.summary;
  Section section;
  section.id = "pose";
  section.heading = "Pose";
  section.above_html =
      html::paragraphHtml(drawsText(summary)) + html::tableHtml(poseTable(summary));
  if (summary.modes.size() > 1)
    section.above_html += html::tableHtml(modesTable(summary.modes));
  return section;
}

Section
cloudSection(const Run& run)
{
  Section section;
  section.id = "clouds";
  section.heading = "Clouds before and after";
  section.above_html =
      html::paragraphHtml(
          std::string("In the target frame; before: the source at the initial guess; "
                      "after: at the final transformation, ") +
          (run.result.is_final_the_mean ? "the posterior mean." : "ICP's result.")) +
      html::legendHtml({{source_colour, "source"}, {target_colour, "target"}});
  section.charts = cloudCharts(run);
  section.grid = html::FigureGrid::Pairs;
  return section;
}

std::string
dataSummary(const DataReport& data)
{
  constexpr double percent = 100.0, millimetres = 1e3;
  return "Noise: " + io::textOf(millimetres * data.noise_scale, 4) +
         " mm from the surface, " + io::fixedTextOf(data.residual_scale, 2) +
         " times the target's own. About " +
         io::fixedTextOf(data.effective_patches, 0) +
         " independent patches of surface hold the pose. " +
         io::fixedTextOf(percent * data.active_fraction, 0) +
         " % of the source points lie on the target's surface.";
}

Section
dataSection(const DataReport& data)
{
  Section section;
  section.id = "data";
  section.heading = "What the clouds say";
  const auto flags = describeFlags(data);
  section.above_html =
      html::tableHtml(directionsTable(data.directions)) +
      html::paragraphHtml(dataSummary(data)) +
      html::paragraphHtml(flags.empty() ? "No flag is raised." : "Flags:") +
      html::listHtml(flags);
  section.charts = {directionChart(data)};
  section.grid = html::FigureGrid::Pairs;
  return section;
}

std::string
chainLegend(const DrawSet& draws)
{
  std::vector<std::pair<std::string, std::string>> colours;
  for (const ChainDraws& chain : draws.chains)
    colours.emplace_back(colourOf(chain.chain), "chain " + io::textOf(chain.chain));
  return colours.size() > max_chains_in_legend ? "" : html::legendHtml(colours);
}

Section
chainSection(const DrawSet& draws, const Summary& summary)
{
  Section section;
  section.id = "chains";
  section.heading = "Do the chains agree?";
  section.above_html = html::paragraphHtml(
      "Good chains cannot be told apart: traces lie on each other without trends, and "
      "every chain has every rank equally often (the dashed line). R-hat at most " +
      io::textOf(max_rhat, 3) + " and effective sample sizes (ESS) of at least " +
      io::textOf(min_ess, 3) + ", all in the first table, are asked for.");
  if (summary.num_diverged_chains > 0)
    section.above_html += html::paragraphHtml(
        io::textOf(summary.num_diverged_chains) + " of " +
        io::textOf(summary.num_chains) +
        " chains diverged and are left out here and everywhere else.");
  section.above_html += chainLegend(draws);
  section.charts = chainCharts(draws);
  return section;
}

Section
repeatSection(const Run& run, const std::string& command)
{
  std::error_code ignored;
  const std::string folder = std::filesystem::current_path(ignored).string();
  const std::string options =
      jsonOf(run.settings)
          .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  Section section;
  section.id = "repeat";
  section.heading = "To repeat the run";
  section.above_html =
      html::paragraphHtml("In the folder " + folder +
                          "; the draws are the same, to the last bit, on any number of "
                          "threads:") +
      html::codeHtml(command) + html::tableHtml(runTable(run)) +
      html::detailsHtml("All options, as --config takes them", html::codeHtml(options));
  return section;
}

} // namespace

std::vector<Section>
reportSections(const Run& run, const std::string& command)
{
  const Summary& summary = run.result.summary;
  const DrawSet draws = drawSetOf(run.result);
  std::vector<Section> sections = {poseSection(run)};
  if (summary.data.is_available)
    sections.push_back(dataSection(summary.data));
  sections.push_back(cloudSection(run));
  sections.push_back(
      {"densities",
       "Posterior of each coordinate",
       html::paragraphHtml("Density of the draws about the mean (dashed); filled: the "
                           "95 % interval."),
       densityCharts(draws),
       "",
       html::FigureGrid::Any});
  sections.push_back(
      {"pairs",
       "Posterior of pairs of coordinates",
       chainLegend(draws),
       {pairChart(draws, summary.covariance(CovarianceConvention::Parameters))},
       "",
       html::FigureGrid::Any});
  sections.push_back(chainSection(draws, summary));
  sections.push_back(repeatSection(run, command));
  return sections;
}

} // namespace bayesian_icp::app
