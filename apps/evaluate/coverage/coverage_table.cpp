#include "coverage_table.h"

#include "coverage_summary.h"
#include "formatted_text.h"

#include <algorithm>
#include <cmath>
#include <ostream>

namespace bayesian_icp::evaluate {

namespace {

constexpr double mm = 1e3;
constexpr double degree = 180.0 / 3.14159265358979323846;

using Runs = std::vector<CoverageRun>;

/** "0.95 [0.90,0.98]" */
std::string
shareText(const Share& share)
{
  return std::isnan(share.value)
             ? format("%16s", "-")
             : format("%4.2f [%.2f,%.2f]", share.value, share.low, share.high);
}

std::string
percentText(const Share& share)
{
  return std::isnan(share.value) ? format("%6s", "-")
                                 : format("%6.0f", 100.0 * share.value);
}

/** Large numbers without digits nobody reads. */
std::string
numberText(double value, int width, int num_decimals)
{
  if (std::isnan(value))
    return format("%*s", width, "-");
  return std::abs(value) < (num_decimals > 0 ? 1e4 : 1e7)
             ? format("%*.*f", width, num_decimals, value)
             : format("%*.1e", width, value);
}

void
printLine(const std::string& method,
          const CoverageSummary& summary,
          std::ostream& stream)
{
  stream << format("  %-23s %5zu/%-5zu",
                   method.c_str(),
                   summary.num_valid,
                   summary.num_runs)
         << numberText(summary.anees, 9, 2);
  for (const Share& share : summary.coverage)
    stream << "  " << shareText(share);
  const double queries =
      summary.median_queries >= 0.0 ? summary.median_queries : std::nan("");
  stream << numberText(summary.mean_log_score, 9, 2)
         << numberText(summary.mean_energy_score, 8, 4)
         << numberText(mm * summary.translation_error, 9, 2)
         << numberText(degree * summary.rotation_error, 8, 2)
         << percentText(summary.flagged) << percentText(summary.flagged_outside)
         << numberText(summary.median_seconds, 9, 3) << numberText(queries, 9, 0)
         << '\n';
}

void
printBlock(const std::string& title, const Runs& runs, std::ostream& stream)
{
  if (runs.empty())
    return;
  stream << title << '\n';
  for (const auto& [method, of_method] : runsByMethod(runs))
    printLine(method, summaryOf(of_method), stream);
}

Runs
select(const Runs& runs, const std::string& scene, const std::string& condition)
{
  Runs selected;
  for (const CoverageRun& run : runs)
    if ((scene.empty() || run.name.scene == scene) &&
        (condition.empty() || run.name.condition == condition))
      selected.push_back(run);
  return selected;
}

std::vector<std::string>
namesOf(const Runs& runs, std::string CoverageRunName::*member)
{
  std::vector<std::string> names;
  for (const CoverageRun& run : runs)
    if (std::find(names.begin(), names.end(), run.name.*member) == names.end())
      names.push_back(run.name.*member);
  return names;
}

void
printHeader(std::ostream& stream)
{
  stream
      << "                               valid     mean  share of truths within the "
         "region of "
         "probability ..., and its 95 % interval      mean    mean   median  median  "
         "flagged %   median   median\n"
         "  method                       /runs   NEES/6              50 %              "
         "68 %   "
         "  "
         "         90 %              95 %    log p  energy       mm     deg   all "
         "out95  "
         "      s  queries\n";
}

} // namespace

std::vector<std::pair<std::string, Runs>>
runsByMethod(const Runs& runs)
{
  std::vector<std::pair<std::string, Runs>> methods;
  for (const std::string& method : namesOf(runs, &CoverageRunName::method)) {
    methods.emplace_back(method, Runs());
    for (const CoverageRun& run : runs)
      if (run.name.method == method)
        methods.back().second.push_back(run);
  }
  return methods;
}

void
printCoverageTable(const Runs& runs, std::ostream& stream)
{
  const auto scenes = namesOf(runs, &CoverageRunName::scene);
  const auto conditions = namesOf(runs, &CoverageRunName::condition);
  printHeader(stream);
  for (const std::string& scene : scenes)
    for (const std::string& condition : conditions)
      printBlock(std::string(scene).append(", ").append(condition),
                 select(runs, scene, condition),
                 stream);
  if (conditions.size() > 1)
    for (const std::string& scene : scenes)
      printBlock(scene + ", all conditions", select(runs, scene, ""), stream);
  if (scenes.size() > 1 && conditions.size() > 1)
    for (const std::string& condition : conditions)
      printBlock("all scenes, " + condition, select(runs, "", condition), stream);
  if (scenes.size() * conditions.size() > 1)
    printBlock("all", runs, stream);
}

} // namespace bayesian_icp::evaluate
