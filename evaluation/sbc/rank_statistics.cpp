#include "sbc/rank_statistics.h"

#include <numeric>

namespace bayesian_icp::evaluate {

namespace {

Vector6d
coordinatesOf(const Vector6d& pose, const Prior& prior)
{
  Vector6d coordinates = prior.deviation(pose);
  for (int k = 3; k < 6; ++k)
    coordinates[k] = wrapAngle(coordinates[k]);
  return coordinates;
}

} // namespace

Ranks
ranksOf(const Vector6d& true_pose, const PoseMatrix& draws, const Prior& prior)
{
  const Vector6d truth = coordinatesOf(true_pose, prior);
  const Eigen::Index step = draws.rows() / num_ranked_draws;
  Ranks ranks = Ranks::Zero();
  for (int i = 0; i < num_ranked_draws; ++i) {
    const Vector6d draw = coordinatesOf(draws.row(step * i).transpose(), prior);
    ranks += (draw.array() < truth.array()).cast<int>().matrix();
  }
  return ranks;
}

RankHistogram
rankHistogram(const std::vector<Ranks>& runs, int k)
{
  RankHistogram histogram = {};
  for (const Ranks& ranks : runs)
    ++histogram[static_cast<std::size_t>(ranks[k] * num_rank_bins /
                                         (num_ranked_draws + 1))];
  return histogram;
}

double
chiSquareOf(const RankHistogram& histogram)
{
  const double expected = std::accumulate(histogram.begin(), histogram.end(), 0.0) /
                          static_cast<double>(histogram.size());
  double sum = 0.0;
  for (const int count : histogram)
    sum += (count - expected) * (count - expected) / expected;
  return sum;
}

} // namespace bayesian_icp::evaluate
