#include "coverage/coverage_summary.h"

#include "io/coordinates.h"
#include "study/draw_statistics.h"

#include <boost/math/distributions/normal.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <set>
#include <string>

namespace bayesian_icp::evaluate {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

using Scores = std::vector<CoverageScore>;

template <typename Item, typename Condition>
std::vector<Item>
select(const std::vector<Item>& items, const Condition& condition)
{
  std::vector<Item> selected;
  for (const Item& item : items)
    if (std::invoke(condition, item))
      selected.push_back(item);
  return selected;
}

/** The numbers of the scores that have one. */
template <typename Number>
std::vector<double>
collect(const Scores& scores, const Number& number)
{
  std::vector<double> values;
  for (const CoverageScore& score : scores)
    if (const auto value = static_cast<double>(std::invoke(number, score));
        !std::isnan(value))
      values.push_back(value);
  return values;
}

template <typename Number>
double
meanOf(const Scores& scores, const Number& number)
{
  const std::vector<double> values = collect(scores, number);
  return std::accumulate(values.begin(), values.end(), 0.0) /
         static_cast<double>(values.size());
}

template <typename Number>
double
medianOf(const Scores& scores, const Number& number)
{
  const std::vector<double> values = collect(scores, number);
  return values.empty() ? nan : median(values);
}

/** Share of the scores that fulfil a condition. */
template <typename Condition>
Share
shareWhere(const Scores& scores,
           const Condition& condition,
           std::size_t most_independent)
{
  return shareOf(select(scores, condition).size(), scores.size(), most_independent);
}

/** Number of different pairs of scans if the runs are of real ones. */
std::size_t
mostIndependent(const std::vector<CoverageRun>& runs)
{
  std::set<std::string> pairs;
  for (const CoverageRun& run : runs) {
    if (run.name.condition != real_pair)
      return runs.size();
    pairs.insert(run.name.scene);
  }
  return pairs.size();
}

void
countDoubts(const Scores& scores, CoverageSummary& summary)
{
  for (const CoverageScore& score : scores) {
    if (score.hasPose() && !score.is_valid)
      continue;
    const bool is_doubted = score.isFlagged() || !score.is_valid;
    const bool is_good = !score.isLost() && score.nees < max_good_nees;
    const bool is_bad = score.isLost() || score.nees > min_bad_nees;
    summary.num_good += is_good ? 1 : 0;
    summary.num_alarms += is_good && is_doubted ? 1 : 0;
    summary.num_bad += is_bad ? 1 : 0;
    summary.num_misses += is_bad && !is_doubted ? 1 : 0;
  }
}

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
  return select(runs, [&](const CoverageRun& run) { return run.name.*member == name; });
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

Share
shareOf(std::size_t num_hits, std::size_t num_trials, std::size_t most_independent)
{
  if (num_trials == 0)
    return {nan, nan, nan};
  static const double z = boost::math::quantile(boost::math::normal(), 0.975);
  const double share = static_cast<double>(num_hits) / static_cast<double>(num_trials);
  const auto n = static_cast<double>(std::min(num_trials, most_independent));
  const double centre = (share + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double half_width =
      z / (1.0 + z * z / n) *
      std::sqrt(share * (1.0 - share) / n + z * z / (4.0 * n * n));
  return {
      share, std::max(0.0, centre - half_width), std::min(1.0, centre + half_width)};
}

CoverageSummary
summaryOf(const std::vector<CoverageRun>& runs)
{
  Scores scores;
  for (const CoverageRun& run : runs)
    scores.push_back(run.score);
  const Scores found = select(scores, [](const auto& s) { return !s.isLost(); });
  const Scores posed = select(scores, &CoverageScore::hasPose);
  const Scores outside = select(posed, [](const auto& s) { return s.region > 0.95; });
  const Scores placed =
      select(scores, [](const auto& s) { return !std::isnan(s.region); });
  const std::size_t most_independent = mostIndependent(runs);
  CoverageSummary summary;
  summary.num_runs = runs.size();
  summary.num_valid = select(scores, &CoverageScore::is_valid).size();
  summary.num_lost = scores.size() - found.size();
  countDoubts(scores, summary);
  summary.anees = meanOf(found, [](const auto& s) { return s.nees / 6.0; });
  for (std::size_t i = 0; i < coverage_levels.size(); ++i)
    summary.coverage[i] = shareWhere(
        placed,
        [level = coverage_levels[i]](const auto& s) { return s.region <= level; },
        most_independent);
  summary.mean_log_score = meanOf(scores, &CoverageScore::log_score);
  summary.mean_energy_score = meanOf(scores, &CoverageScore::energy_score);
  summary.translation_error = medianOf(scores, &CoverageScore::translation_error);
  summary.rotation_error = medianOf(scores, &CoverageScore::rotation_error);
  summary.flagged = shareWhere(posed, &CoverageScore::isFlagged, most_independent);
  summary.flagged_outside =
      shareWhere(outside, &CoverageScore::isFlagged, most_independent);
  summary.median_seconds = medianOf(posed, &CoverageScore::seconds);
  summary.median_queries = medianOf(posed, &CoverageScore::num_queries);
  return summary;
}

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
