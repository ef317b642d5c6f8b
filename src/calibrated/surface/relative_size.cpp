#include "calibrated/surface/relative_size.h"

#include "calibrated/surface/even_choice.h"
#include "calibrated/surface/surface_model.h"
#include "geometry/twist.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <unordered_set>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

namespace {

/** Size of a cube as a fraction of the root mean square distance of the points of a
 * cloud from their centroid. It holds the gaps between the lines of a scan. */
constexpr double cube_to_spread = 0.05;
/** Largest number of points that are counted. */
constexpr Index max_points = 100000;

/** Standard deviations of the prior that the reach covers. */
constexpr double num_deviations = 3.0;
/** If fewer points are within reach, all are used. */
constexpr std::size_t min_points_within = 1000;

/** At most max_points finite columns, at equal steps. */
std::vector<Index>
someColumns(const Matrix3Xd& points)
{
  std::vector<Index> columns;
  const Index step = (points.cols() + max_points - 1) / max_points;
  for (Index i = 0; i < points.cols(); i += step)
    if (points.col(i).allFinite())
      columns.push_back(i);
  return columns;
}

/** Number of cubes that hold points. */
std::size_t
numCubes(const Eigen::Matrix3Xf& points, double cube)
{
  constexpr int num_bits = 21;
  constexpr std::int64_t num_places = std::int64_t(1) << num_bits;
  // Points that are further away share the outermost cubes.
  constexpr double furthest = num_places / 2 - 1;
  std::unordered_set<std::int64_t> cubes;
  for (const auto& point : points.colwise()) {
    const Eigen::Array<std::int64_t, 3, 1> place = (point.cast<double>().array() / cube)
                                                       .floor()
                                                       .max(-furthest)
                                                       .min(furthest)
                                                       .cast<std::int64_t>();
    cubes.insert((place[0] * num_places + place[1]) * num_places + place[2]);
  }
  return cubes.size();
}

} // namespace

int
numDoublings(const Matrix3Xd& cloud, const Matrix3Xd& other)
{
  const std::vector<Index> of_cloud = someColumns(cloud), of_other = someColumns(other);
  if (of_cloud.empty() || of_other.empty())
    return 0;
  const auto centred = [](const Matrix3Xd& points, const std::vector<Index>& columns) {
    return relativeTo(centroidOf(points, columns), points, columns);
  };
  const Eigen::Matrix3Xf small = centred(other, of_other);
  const double cube = cube_to_spread * spreadOf(small);
  if (!(cube > 0.0 && std::isfinite(cube)))
    return 0;
  const double ratio = static_cast<double>(numCubes(centred(cloud, of_cloud), cube)) /
                       static_cast<double>(numCubes(small, cube));
  // One less than would make patches as dense as those of a scan: each takes its time.
  int num_doublings =
      std::clamp(static_cast<int>(std::floor(std::log2(ratio))) - 1, 0, max_doublings);
  // Not more than there are points for.
  while (num_doublings > 0 && Index(SurfaceModelOptions().max_patches)
                                      << (num_doublings - 1) >=
                                  cloud.cols())
    --num_doublings;
  return num_doublings;
}

Reach
reachOf(const Matrix3Xd& source, const std::vector<Index>& columns, const Prior& prior)
{
  const Vector3d centroid = centroidOf(source, columns);
  double squared_radius = 0.0;
  for (const Index column : columns)
    squared_radius =
        std::max(squared_radius, (source.col(column) - centroid).squaredNorm());
  // The prior shifts the reference point, and turns the centroid about it.
  const Vector6d deviations = num_deviations * prior.variance().cwiseSqrt();
  const double turn = std::min(2.0, deviations.tail<3>().norm());
  return {isometryOf(prior.mean()) * centroid,
          std::sqrt(squared_radius) + deviations.head<3>().norm() +
              turn * (centroid - prior.referencePoint()).norm()};
}

std::vector<Index>
columnsWithin(const Reach& reach,
              const Matrix3Xd& target,
              const std::vector<Index>& columns)
{
  std::vector<Index> within;
  std::copy_if(
      columns.begin(), columns.end(), std::back_inserter(within), [&](Index column) {
        return (target.col(column) - reach.centre).squaredNorm() <=
               reach.radius * reach.radius;
      });
  return within.size() >= std::min(min_points_within, columns.size()) ? within
                                                                      : columns;
}

} // namespace bayesian_icp
