#include "coverage/coverage_summary.h"

#include "study/draw_statistics.h"

#include <boost/math/distributions/normal.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <set>
#include <string>

namespace bayesian_icp::evaluate {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

using Scores = std::vector<CoverageScore>;

template <typename Condition>
Scores
select(const Scores& scores, const Condition& condition)
{
  Scores selected;
  std::copy_if(
      scores.begin(),
      scores.end(),
      std::back_inserter(selected),
      [&](const CoverageScore& score) { return std::invoke(condition, score); });
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

Share
shareOfFlagged(const Scores& scores, std::size_t most_independent)
{
  return shareOf(select(scores, &CoverageScore::isFlagged).size(),
                 scores.size(),
                 most_independent);
}

/** Share of the scores with the truth within the region of probability \p level. */
Share
shareWithin(const Scores& scores, double level, std::size_t most_independent)
{
  const auto regions = collect(scores, &CoverageScore::region);
  const auto num_within =
      std::count_if(regions.begin(), regions.end(), [level](double region) {
        return region <= level;
      });
  return shareOf(
      static_cast<std::size_t>(num_within), regions.size(), most_independent);
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
  const std::size_t most_independent = mostIndependent(runs);
  CoverageSummary summary;
  summary.num_runs = runs.size();
  summary.num_valid = select(scores, &CoverageScore::is_valid).size();
  summary.num_lost = scores.size() - found.size();
  countDoubts(scores, summary);
  summary.anees = meanOf(found, [](const auto& s) { return s.nees / 6.0; });
  for (std::size_t i = 0; i < coverage_levels.size(); ++i)
    summary.coverage[i] = shareWithin(scores, coverage_levels[i], most_independent);
  summary.mean_log_score = meanOf(scores, &CoverageScore::log_score);
  summary.mean_energy_score = meanOf(scores, &CoverageScore::energy_score);
  summary.translation_error = medianOf(scores, &CoverageScore::translation_error);
  summary.rotation_error = medianOf(scores, &CoverageScore::rotation_error);
  summary.flagged = shareOfFlagged(posed, most_independent);
  summary.flagged_outside = shareOfFlagged(outside, most_independent);
  summary.median_seconds = medianOf(posed, &CoverageScore::seconds);
  summary.median_queries = medianOf(posed, &CoverageScore::num_queries);
  return summary;
}

} // namespace bayesian_icp::evaluate
