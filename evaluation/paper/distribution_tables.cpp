#include "paper/distribution_tables.h"

#include "coverage/coverage_summary.h"
#include "draw_statistics.h"

#include <io/numbers.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace bayesian_icp::evaluate {

namespace {

using Cells = std::vector<std::string>;

constexpr double region_95 = 0.95;

/** A row a method. */
ReportTable
methodTable(const PairDistribution& pair,
            const std::string& caption,
            const std::vector<std::pair<std::string, RunNumber>>& columns)
{
  ReportTable table;
  table.caption = pair.pair->name + ": " + caption;
  table.header = {"method"};
  for (const auto& column : columns)
    table.header.push_back(column.first);
  for (const PaperMethod& method : paperMethods()) {
    Cells row = {method.title};
    for (const auto& column : columns)
      row.push_back(textOf(spreadIn(pair, method.name, column.second)));
    table.rows.push_back(std::move(row));
  }
  return table;
}

/** "not_mixed 9, diverged 1". */
std::string
statusesOf(const PairDistribution& pair, const std::string& method)
{
  std::map<std::string, int> counts;
  for (const DistributionRun& run : pair.runs)
    if (run.name.method == method)
      ++counts[run.score.status];
  std::string text;
  for (const auto& [status, count] : counts)
    text += (text.empty() ? "" : ", ") + status + " " + std::to_string(count);
  return text;
}

/** Root mean square over x, y, z, or over the angles. */
double
spreadOfRun(const DistributionRun& run, int first)
{
  return run.standard_deviation.segment<3>(first).norm() / std::sqrt(3.0);
}

} // namespace

std::vector<ReportTable>
divergenceTables(const Distributions& distributions)
{
  std::vector<std::pair<std::string, RunNumber>> columns;
  columns.reserve(9);
  for (int k = 0; k < 6; ++k)
    columns.emplace_back(coordinate_names[static_cast<std::size_t>(k)],
                         coordinateKl(k));
  columns.emplace_back("6-D", [](const DistributionRun& run) { return run.score.kl; });
  columns.emplace_back("yaw, main basin", [](const DistributionRun& run) {
    return run.main_coordinate_kl[5];
  });
  columns.emplace_back("6-D, main basin",
                       [](const DistributionRun& run) { return run.main_kl; });
  std::vector<ReportTable> tables;
  for (const PairDistribution& pair : distributions)
    tables.push_back(methodTable(
        pair,
        "KL(baseline ‖ method) [nats]; main basin: of the baseline's runs in it only.",
        columns));
  return tables;
}

std::vector<ReportTable>
scoreTables(const Distributions& distributions)
{
  std::vector<std::pair<std::string, RunNumber>> columns;
  columns.reserve(12);
  for (int k = 0; k < 6; ++k)
    columns.emplace_back(
        std::string("W1 ") + coordinate_names[static_cast<std::size_t>(k)],
        [k](const DistributionRun& run) { return run.score.wasserstein[k]; });
  const auto add = [&columns](const char* name, double DistributionRun::*number) {
    columns.emplace_back(name,
                         [number](const DistributionRun& run) { return run.*number; });
  };
  add("energy score, baseline", &DistributionRun::energy_score);
  add("energy score, truth", &DistributionRun::truth_energy_score);
  add("NEES / 6", &DistributionRun::nees);
  columns.back().second = [](const DistributionRun& run) { return run.nees / 6.0; };
  columns.emplace_back("truth in 95 % region [share]", [](const DistributionRun& run) {
    return std::isnan(run.nees) ? run.nees : regionOf(run.nees) <= region_95;
  });
  add("translation error [m]", &DistributionRun::translation_error);
  add("rotation error [rad]", &DistributionRun::rotation_error);
  std::vector<ReportTable> tables;
  for (const PairDistribution& pair : distributions)
    tables.push_back(
        methodTable(pair,
                    "Wasserstein-1 distances to the baseline in standard deviations of "
                    "it; energy scores in units of the prior's standard deviations; "
                    "NEES, coverage and errors are against the true pose.",
                    columns));
  return tables;
}

ReportTable
mixingTable(const Distributions& distributions)
{
  ReportTable table;
  table.caption =
      "Whether the chains sampled their posterior: statuses of the runs, "
      "median of the largest R-hat and of the smallest bulk effective sample "
      "size of a coordinate, and spread of the draws (root mean square over "
      "the three axes).";
  table.header = {"pair, method",
                  "status",
                  "R-hat",
                  "bulk ESS",
                  "translation sd [m]",
                  "rotation sd [rad]",
                  "CPU time of a run [s]"};
  for (const PairDistribution& pair : distributions)
    for (const char* name :
         {"bayesian-icp", "bayesian-icp-1e-5", "exact", "calibrated"}) {
      const auto medianIn = [&](const RunNumber& number) {
        std::vector<double> values;
        for (const DistributionRun& run : pair.runs)
          if (run.name.method == name)
            values.push_back(number(run));
        return median(values);
      };
      table.rows.push_back(
          {pair.pair->name + ", " + paperMethod(name).title,
           statusesOf(pair, name),
           shortText(medianIn([](const auto& run) { return run.score.rhat; })),
           io::fixedTextOf(medianIn([](const auto& run) { return run.score.bulk_ess; }),
                           0),
           io::textOf(medianIn([](const auto& run) { return spreadOfRun(run, 0); }), 3),
           io::textOf(medianIn([](const auto& run) { return spreadOfRun(run, 3); }), 3),
           io::textOf(medianIn([](const auto& run) { return run.score.seconds; }), 2)});
    }
  return table;
}

ReportTable
baselineTable(const Distributions& distributions)
{
  ReportTable table;
  table.caption = "The baseline: results of Monte Carlo ICP, all kept as in the paper. "
                  "Main basin: mean squared distance at most twice the least.";
  table.header = {"pair", "points source / target", "runs", "in main basin [%]"};
  for (int k = 0; k < 6; ++k)
    table.header.push_back(std::string("sd ") +
                           coordinate_names[static_cast<std::size_t>(k)] +
                           (k < 3 ? " [m]" : " [rad]"));
  for (const PairDistribution& pair : distributions) {
    const PaperBaseline& baseline = pair.baseline;
    Cells row = {pair.pair->name,
                 std::to_string(pair.pair->source.cols()) + " / " +
                     std::to_string(pair.pair->target.cols()),
                 std::to_string(baseline.ends.rows()),
                 io::fixedTextOf(100.0 * baseline.mainShare(), 1)};
    const Moments moments = momentsOf(unwrapAbout(baseline.mean, baseline.ends));
    for (int k = 0; k < 6; ++k)
      row.push_back(io::textOf(std::sqrt(moments.covariance(k, k)), 3));
    table.rows.push_back(std::move(row));
  }
  return table;
}

} // namespace bayesian_icp::evaluate
