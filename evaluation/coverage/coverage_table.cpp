#include "coverage/coverage_summary.h"
#include "io/coordinates.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace bayesian_icp::evaluate {

namespace {

constexpr double mm = 1e3;
constexpr double mrad = 1e3;

using Runs = std::vector<CoverageRun>;

/** "0.95 [0.90,0.98]" */
std::string
shareText(const Share& share)
{
  return std::isnan(share.value)
             ? "-"
             : format("%4.2f [%.2f,%.2f]", share.value, share.low, share.high);
}

/** "2/31" */
std::string
countText(std::size_t count, std::size_t of)
{
  return std::to_string(count) + '/' + std::to_string(of);
}

/** What is told of the runs of a method. */
struct Column {
  std::string title;
  std::function<std::string(const CoverageSummary&)> cell;
};

using Columns = std::vector<Column>;

Column
numberColumn(const std::string& title,
             double CoverageSummary::*number,
             int num_decimals,
             double factor = 1.0)
{
  return {title, [=](const CoverageSummary& s) {
            return numberText(factor * s.*number, num_decimals);
          }};
}

Column
percentColumn(const std::string& title, Share CoverageSummary::*share)
{
  return {title, [=](const CoverageSummary& s) {
            return numberText(100.0 * (s.*share).value, 0);
          }};
}

Column
shareColumn(std::size_t level)
{
  return {"truths within\n" + format("%.0f %%", 100.0 * coverage_levels[level]),
          [=](const CoverageSummary& s) { return shareText(s.coverage[level]); }};
}

const Columns&
simulatedColumns()
{
  static const Columns columns = {
      {"valid\n/runs",
       [](const CoverageSummary& s) { return countText(s.num_valid, s.num_runs); }},
      numberColumn("mean\nNEES/6", &CoverageSummary::anees, 2),
      shareColumn(0),
      shareColumn(1),
      shareColumn(2),
      shareColumn(3),
      numberColumn("mean\nlog p", &CoverageSummary::mean_log_score, 2),
      numberColumn("energy\nscore", &CoverageSummary::mean_energy_score, 4),
      numberColumn("median\nerror [mm]", &CoverageSummary::translation_error, 2, mm),
      numberColumn("median\nerror [deg]",
                   &CoverageSummary::rotation_error,
                   2,
                   app::degrees_per_radian),
      percentColumn("flagged\n[%]", &CoverageSummary::flagged),
      percentColumn("flagged if\noutside [%]", &CoverageSummary::flagged_outside),
      numberColumn("median\ntime [s]", &CoverageSummary::median_seconds, 3),
      {"median\nqueries", [](const CoverageSummary& s) {
         return numberText(s.median_queries >= 0.0 ? s.median_queries : std::nan(""),
                           0);
       }}};
  return columns;
}

/** Of recordings, whose poses can be lost. */
const Columns&
sequenceColumns()
{
  static const Columns columns = {
      {"\npairs", [](const CoverageSummary& s) { return std::to_string(s.num_runs); }},
      {"\nlost", [](const CoverageSummary& s) { return std::to_string(s.num_lost); }},
      numberColumn("mean NEES/6\nnot lost", &CoverageSummary::anees, 2),
      shareColumn(0),
      shareColumn(coverage_levels.size() - 1),
      numberColumn("mean\nlog p", &CoverageSummary::mean_log_score, 2),
      numberColumn("median\nerror [mm]", &CoverageSummary::translation_error, 2, mm),
      numberColumn("median\nerror [mrad]", &CoverageSummary::rotation_error, 3, mrad),
      {"alarms\n/good",
       [](const CoverageSummary& s) { return countText(s.num_alarms, s.num_good); }},
      {"misses\n/bad",
       [](const CoverageSummary& s) { return countText(s.num_misses, s.num_bad); }},
      numberColumn("median\ntime [s]", &CoverageSummary::median_seconds, 3)};
  return columns;
}

using Member = std::string CoverageRunName::*;

std::vector<std::string>
namesOf(const Runs& runs, Member member)
{
  std::vector<std::string> names;
  for (const CoverageRun& run : runs)
    if (std::find(names.begin(), names.end(), run.name.*member) == names.end())
      names.push_back(run.name.*member);
  return names;
}

Runs
select(const Runs& runs, Member member, const std::string& name)
{
  Runs selected;
  for (const CoverageRun& run : runs)
    if (run.name.*member == name)
      selected.push_back(run);
  return selected;
}

/** A row of each method, in order of appearance. */
void
addBlock(const std::string& title,
         const Runs& runs,
         const Columns& columns,
         TextTable& table)
{
  if (runs.empty())
    return;
  table.addTitle(title);
  for (const std::string& method : namesOf(runs, &CoverageRunName::method)) {
    const CoverageSummary summary =
        summaryOf(select(runs, &CoverageRunName::method, method));
    std::vector<std::string> cells = {method};
    for (const Column& column : columns)
      cells.push_back(column.cell(summary));
    table.add(cells);
  }
}

/** Of runs that are all of recordings, or none of them. */
TextTable
tableOf(const Runs& runs, const Columns& columns)
{
  const auto scenes = namesOf(runs, &CoverageRunName::scene);
  const auto conditions = namesOf(runs, &CoverageRunName::condition);
  std::vector<std::string> header = {"\nmethod"};
  for (const Column& column : columns)
    header.push_back(column.title);
  TextTable table(header);
  const auto add = [&](const std::string& title, const Runs& block) {
    addBlock(title, block, columns, table);
  };
  for (const std::string& scene : scenes)
    for (const std::string& condition : conditions)
      add(std::string(scene).append(", ").append(condition),
          select(select(runs, &CoverageRunName::scene, scene),
                 &CoverageRunName::condition,
                 condition));
  for (const std::string& scene : scenes)
    if (const Runs pool = select(runs, &CoverageRunName::scene, scene);
        namesOf(pool, &CoverageRunName::condition).size() > 1)
      add(scene + ", all conditions", pool);
  for (const std::string& condition : conditions)
    if (const Runs pool = select(runs, &CoverageRunName::condition, condition);
        conditions.size() > 1 && namesOf(pool, &CoverageRunName::scene).size() > 1)
      add("all scenes, " + condition, pool);
  if (scenes.size() * conditions.size() > 1)
    add("all", runs);
  return table;
}

} // namespace

std::vector<TextTable>
coverageTables(const Runs& runs)
{
  Runs simulated, recorded;
  for (const CoverageRun& run : runs)
    (run.score.hasLimit() ? recorded : simulated).push_back(run);
  std::vector<TextTable> tables;
  if (!simulated.empty())
    tables.push_back(tableOf(simulated, simulatedColumns()));
  if (!recorded.empty())
    tables.push_back(tableOf(recorded, sequenceColumns()));
  return tables;
}

} // namespace bayesian_icp::evaluate
