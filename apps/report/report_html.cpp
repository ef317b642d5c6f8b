#include "report/report_html.h"

#include "io/coordinates.h"
#include "io/numbers.h"
#include "register/report_text.h"
#include "register/settings_json.h"
#include "report/charts.h"
#include "report/verdict.h"

#include <pcl/pcl_config.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>

namespace bayesian_icp::app {

namespace {

constexpr double per_thousand = 1e3;
/** For numbers that are not finite. */
constexpr const char* unknown = "–";

using Cells = std::vector<std::string>;

std::string
titleOf(const Run& run)
{
  const auto nameOf = [](const io::CloudFile& cloud) {
    const std::filesystem::path path(cloud.file);
    return (path.parent_path().filename() / path.filename()).string();
  };
  return nameOf(run.source) + " registered to " + nameOf(run.target);
}

std::string
verdictHtml(const Run& run)
{
  const Verdict verdict = verdictOf(run.result.summary, run.settings.options.preset);
  const std::string note = icpNote(run);
  const std::string warning = "The pose above is the posterior mean, but " + note + '.';
  return html::boxHtml(
             verdict.tone, verdict.heading, html::paragraphHtml(verdict.sentence)) +
         (note.empty() ? ""
                       : html::boxHtml(html::Tone::Caution,
                                       "Use the final transformation with care",
                                       html::paragraphHtml(warning))) +
         html::paragraphHtml(
             "The pose maps source points into the target frame; ± is one standard "
             "deviation. " +
             verdict.scale_note) +
         html::paragraphHtml("Status: " + statusText(run.result.summary));
}

std::string
cloudText(const io::CloudFile& cloud)
{
  return cloud.file + ", " + io::textOf(cloud.points.cols()) + " points, " +
         io::textOf(cloud.num_finite) + " of them finite";
}

/** Mean, deviation, interval and diagnostics of each coordinate [m, rad], and
 * angles in degrees. */
html::Table
poseTable(const Summary& summary)
{
  std::vector<Cells> rows = coordinateCells(summary, "°", unknown);
  const Cells header = {
      "", "mean pose", "std. dev.", "2.5 %", "97.5 %", "R-hat", "bulk ESS", "tail ESS"};
  for (Cells& cells : rows)
    cells.resize(header.size());
  return {"Pose that maps source points into the target frame; R = Rz(yaw) Ry(pitch) "
          "Rx(roll)",
          header,
          rows};
}

/** Mean and deviation in each mode. */
html::Table
modesTable(const std::vector<Mode>& modes)
{
  html::Table table;
  table.caption = "Modes between which no chain travels: mean ± standard deviation in "
                  "each; weights are estimates, accurate to a factor of a few";
  table.header = {"mode", "weight", "chains"};
  for (int k = 0; k < 6; ++k)
    table.header.push_back(nameWithUnit(k, "°"));
  for (std::size_t i = 0; i < modes.size(); ++i) {
    std::string chains;
    for (const int chain : modes[i].chains)
      chains += (chains.empty() ? "" : ", ") + io::textOf(chain);
    Cells cells = {io::textOf(i + 1), io::fixedTextOf(modes[i].weight, 3), chains};
    const Matrix6d& covariance = modes[i].covariance(CovarianceConvention::Parameters);
    for (int k = 0; k < 6; ++k) {
      const double factor = isAngle(k) ? degrees_per_radian : 1.0;
      cells.push_back(numberText(factor * modes[i].mean[k], 4, unknown) + " ± " +
                      numberText(factor * std::sqrt(covariance(k, k)), 4, unknown));
    }
    table.rows.push_back(cells);
  }
  return table;
}

/** How well the clouds hold each motion. */
html::Table
directionsTable(const std::vector<DataDirection>& directions)
{
  html::Table table;
  table.caption = "Six independent motions, best known first; standard deviations as "
                  "root mean square displacement of the source's points, and as angle";
  table.header = {"", "std. dev. [mm]", "[mrad]", "prior [mm]", "held by", "motion"};
  table.first_column_of_words = 4;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const DataDirection& direction = directions[i];
    table.rows.push_back(
        {io::textOf(i + 1),
         numberText(per_thousand * direction.standard_deviation, 3, unknown),
         numberText(per_thousand * angularDeviation(direction), 3, unknown),
         numberText(per_thousand * direction.prior_standard_deviation, 1, unknown),
         holderOf(direction.observability),
         direction.description});
  }
  return table;
}

/** Files, sizes, times, versions. */
html::Table
runTable(const Run& run)
{
  const RegistrationResult& result = run.result;
  const std::string icp_time =
      result.has_icp ? "ICP " + io::fixedTextOf(result.icp_seconds, 2) + " s, " : "";
  return {
      "The run",
      {"", ""},
      {{"source", cloudText(run.source)},
       {"target", cloudText(run.target)},
       {"ICP", result.has_icp ? icpText(result) : "was not run"},
       {"final transformation",
        result.is_final_the_mean ? "the posterior mean" : "ICP's result"},
       {"time",
        icp_time + "sampling " + io::fixedTextOf(result.sampling_seconds, 2) + " s"},
       {"versions",
        "pcl_bayesian_icp " BAYESIAN_ICP_VERSION ", PCL " PCL_VERSION_PRETTY
        ", Eigen " +
            io::textOf(EIGEN_WORLD_VERSION) + '.' + io::textOf(EIGEN_MAJOR_VERSION) +
            '.' + io::textOf(EIGEN_MINOR_VERSION)}},
      1};
}

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
poseSection(const Summary& summary)
{
  return {
      "pose",
      "Pose",
      html::paragraphHtml(drawsText(summary)) + html::tableHtml(poseTable(summary)) +
          (summary.modes.size() > 1 ? html::tableHtml(modesTable(summary.modes)) : "")};
}

Section
cloudSection(const Run& run)
{
  return {
      "clouds",
      "Clouds before and after",
      html::paragraphHtml(
          std::string("In the target frame; before: the source at the initial guess; "
                      "after: at the final transformation, ") +
          (run.result.is_final_the_mean ? "the posterior mean." : "ICP's result.")) +
          html::legendHtml({{source_colour, "source"}, {target_colour, "target"}}),
      cloudCharts(run),
      "",
      html::FigureGrid::Pairs};
}

std::string
dataSummary(const DataReport& data)
{
  constexpr double millimetres = 1e3;
  return "Noise: " + io::textOf(millimetres * data.noise_scale, 4) +
         " mm from the surface, " + io::fixedTextOf(data.residual_scale, 2) +
         " times the target's own. About " +
         io::fixedTextOf(data.effective_patches, 0) +
         " independent patches of surface hold the pose. " + describeSupport(data) +
         '.';
}

Section
dataSection(const DataReport& data)
{
  const auto flags = describeFlags(data);
  return {"data",
          "What the clouds say",
          html::tableHtml(directionsTable(data.directions)) +
              html::paragraphHtml(dataSummary(data)) +
              html::paragraphHtml(flags.empty() ? "No flag is raised." : "Flags:") +
              html::listHtml(flags),
          {directionChart(data)},
          "",
          html::FigureGrid::Pairs};
}

/** A chart of each coordinate. */
std::vector<Chart>
chartsOf(const DrawSet& draws, Chart (*chartOf)(const DrawSet&, int))
{
  std::vector<Chart> charts;
  for (int k = 0; k < 6; ++k)
    charts.push_back(chartOf(draws, k));
  return charts;
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
  const std::string diverged = io::textOf(summary.num_diverged_chains) + " of " +
                               io::textOf(summary.num_chains) +
                               " chains diverged and are left out here and everywhere "
                               "else.";
  return {"chains",
          "Do the chains agree?",
          html::paragraphHtml(
              "Good chains cannot be distinguished: traces lie on each other without "
              "trends, and every chain has every rank equally often (the dashed line). "
              "R-hat at most " +
              io::textOf(max_rhat, 3) +
              " and effective sample sizes (ESS) of at least " +
              io::textOf(min_ess, 3) + ", all in the first table, are required.") +
              html::paragraphHtml(summary.num_diverged_chains > 0 ? diverged : "") +
              chainLegend(draws),
          chartsOf(draws, chainChart)};
}

Section
repeatSection(const Run& run, const std::string& command)
{
  return {"repeat",
          "To repeat the run",
          commandHtml(command,
                      "; the draws are the same, to the last bit, on any number of "
                      "threads") +
              html::tableHtml(runTable(run)) +
              html::detailsHtml("All options, as --config takes them",
                                html::codeHtml(jsonOf(run.settings).dump(2)))};
}

/** All parts below the verdict. */
std::vector<Section>
reportSections(const Run& run, const std::string& command)
{
  const Summary& summary = run.result.summary;
  const DrawSet draws = drawSetOf(run.result);
  std::vector<Section> sections = {poseSection(summary)};
  if (summary.data.is_available)
    sections.push_back(dataSection(summary.data));
  sections.push_back(cloudSection(run));
  sections.push_back(
      {"densities",
       "Posterior of each coordinate",
       html::paragraphHtml(
           "Density of the draws about the mean pose (dashed); filled: the "
           "95 % interval."),
       chartsOf(draws, densityChart)});
  sections.push_back(
      {"pairs",
       "Posterior of pairs of coordinates",
       chainLegend(draws),
       {pairChart(draws, summary.covariance(CovarianceConvention::Parameters))}});
  sections.push_back(chainSection(draws, summary));
  sections.push_back(repeatSection(run, command));
  return sections;
}

} // namespace

std::string
reportHtml(const Run& run, const std::string& command)
{
  return html::pageHtml(titleOf(run),
                        verdictHtml(run) + sectionsHtml(reportSections(run, command)));
}

} // namespace bayesian_icp::app
