#include "random_subset.h"

#include <bayesian_icp/random.h>

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace bayesian_icp {

namespace {

/** Stream of the random choice of source points; those of chains count from 0. */
constexpr std::uint64_t subset_stream = std::uint64_t(1) << 40;

} // namespace

Eigen::Matrix3Xd
randomSubset(const Eigen::Matrix3Xd& points, int max_points, std::uint64_t seed)
{
  const auto num_points = static_cast<std::size_t>(points.cols());
  const std::size_t size = std::min(num_points, static_cast<std::size_t>(max_points));
  std::vector<Eigen::Index> order(num_points);
  std::iota(order.begin(), order.end(), Eigen::Index(0));
  Random random(seed, subset_stream);
  Eigen::Matrix3Xd subset(3, static_cast<Eigen::Index>(size));
  for (std::size_t i = 0; i < size; ++i) {
    std::swap(order[i], order[i + random.index(num_points - i)]);
    subset.col(static_cast<Eigen::Index>(i)) = points.col(order[i]);
  }
  return subset;
}

} // namespace bayesian_icp
