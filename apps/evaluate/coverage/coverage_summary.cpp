#include "coverage_summary.h"

#include "draw_statistics.h"

#include <boost/math/distributions/normal.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp::evaluate {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

using Scores = std::vector<CoverageScore>;

template <typename Number>
std::vector<double>
collect(const Scores& scores, const Number& number)
{
  std::vector<double> values;
  for (const CoverageScore& score : scores)
    values.push_back(static_cast<double>(number(score)));
  return values;
}

template <typename Number>
double
meanOf(const Scores& scores, const Number& number)
{
  double sum = 0.0;
  for (const double value : collect(scores, number))
    sum += value;
  return sum / static_cast<double>(scores.size());
}

template <typename Number>
double
medianOf(const Scores& scores, const Number& number)
{
  return scores.empty() ? nan : median(collect(scores, number));
}

Share
shareOfFlagged(const Scores& scores)
{
  const auto num_flagged =
      std::count_if(scores.begin(), scores.end(), [](const CoverageScore& score) {
        return score.isFlagged();
      });
  return shareOf(static_cast<std::size_t>(num_flagged), scores.size());
}

/** Those with the truth beyond the region of probability \p level. */
Scores
outside(const Scores& scores, double level)
{
  Scores found;
  for (const CoverageScore& score : scores)
    if (score.region > level)
      found.push_back(score);
  return found;
}

} // namespace

Share
shareOf(std::size_t num_hits, std::size_t num_trials)
{
  if (num_trials == 0)
    return {nan, nan, nan};
  static const double z = boost::math::quantile(boost::math::normal(), 0.975);
  const auto n = static_cast<double>(num_trials);
  const double share = static_cast<double>(num_hits) / n;
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
    if (run.score.is_valid)
      scores.push_back(run.score);
  CoverageSummary summary;
  summary.num_runs = runs.size();
  summary.num_valid = scores.size();
  summary.anees = meanOf(scores, [](const auto& s) { return s.nees / 6.0; });
  for (std::size_t i = 0; i < coverage_levels.size(); ++i)
    summary.coverage[i] = shareOf(
        scores.size() - outside(scores, coverage_levels[i]).size(), scores.size());
  summary.mean_log_score = meanOf(scores, [](const auto& s) { return s.log_score; });
  summary.mean_energy_score =
      meanOf(scores, [](const auto& s) { return s.energy_score; });
  summary.translation_error =
      medianOf(scores, [](const auto& s) { return s.translation_error; });
  summary.rotation_error =
      medianOf(scores, [](const auto& s) { return s.rotation_error; });
  summary.flagged = shareOfFlagged(scores);
  summary.flagged_outside = shareOfFlagged(outside(scores, 0.95));
  summary.median_seconds = medianOf(scores, [](const auto& s) { return s.seconds; });
  summary.median_queries =
      medianOf(scores, [](const auto& s) { return s.num_queries; });
  return summary;
}

} // namespace bayesian_icp::evaluate
