#include "coverage/coverage_table.h"

#include "coverage/coverage_summary.h"
#include "study/formatted_text.h"

#include <algorithm>
#include <cmath>
#include <ostream>

namespace bayesian_icp::evaluate {

namespace {

constexpr double mm = 1e3;
constexpr double mrad = 1e3;
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

/** "2/31" */
std::string
countText(std::size_t count, std::size_t of, int width)
{
  return format(
      "%*s", width, (std::to_string(count) + '/' + std::to_string(of)).c_str());
}

/** A line of recordings. */
void
printSequenceLine(const std::string& method,
                  const CoverageSummary& summary,
                  std::ostream& stream)
{
  stream << format(
                "  %-23s %5zu %5zu", method.c_str(), summary.num_runs, summary.num_lost)
         << numberText(summary.anees, 9, 2) << "  "
         << shareText(summary.coverage.front()) << "  "
         << shareText(summary.coverage.back())
         << numberText(summary.mean_log_score, 8, 2)
         << numberText(mm * summary.translation_error, 10, 2)
         << numberText(mrad * summary.rotation_error, 9, 3)
         << countText(summary.num_alarms, summary.num_good, 10)
         << countText(summary.num_misses, summary.num_bad, 9)
         << numberText(summary.median_seconds, 9, 3) << '\n';
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

std::vector<std::string>
namesOf(const Runs& runs, std::string CoverageRunName::*member)
{
  std::vector<std::string> names;
  for (const CoverageRun& run : runs)
    if (std::find(names.begin(), names.end(), run.name.*member) == names.end())
      names.push_back(run.name.*member);
  return names;
}

/** The runs of each method, in order of appearance. */
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
printBlock(const std::string& title, const Runs& runs, std::ostream& stream)
{
  if (runs.empty())
    return;
  stream << title << '\n';
  for (const auto& [method, of_method] : runsByMethod(runs)) {
    const CoverageSummary summary = summaryOf(of_method);
    (summary.has_limit ? printSequenceLine : printLine)(method, summary, stream);
  }
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

void
printSequenceHeader(std::ostream& stream)
{
  stream
      << "                                            mean  share of truths within the "
         "region of ...      mean   median   median    alarms   misses   median\n"
         "  method                  pairs  lost   NEES/6              50 %        "
         "      95 %   log p       mm     mrad     /good     /bad        s\n";
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

void
printCoverageTable(const Runs& runs, std::ostream& stream)
{
  const auto scenes = namesOf(runs, &CoverageRunName::scene);
  const auto conditions = namesOf(runs, &CoverageRunName::condition);
  const bool has_limit = !runs.empty() && runs.front().score.hasLimit();
  (has_limit ? printSequenceHeader : printHeader)(stream);
  for (const std::string& scene : scenes)
    for (const std::string& condition : conditions)
      printBlock(std::string(scene).append(", ").append(condition),
                 select(runs, scene, condition),
                 stream);
  for (const std::string& scene : scenes)
    if (const Runs pool = select(runs, scene, "");
        namesOf(pool, &CoverageRunName::condition).size() > 1)
      printBlock(scene + ", all conditions", pool, stream);
  for (const std::string& condition : conditions)
    if (const Runs pool = select(runs, "", condition);
        conditions.size() > 1 && namesOf(pool, &CoverageRunName::scene).size() > 1)
      printBlock("all scenes, " + condition, pool, stream);
  if (scenes.size() * conditions.size() > 1)
    printBlock("all", runs, stream);
}

} // namespace bayesian_icp::evaluate
