#include "calibrated/modes/look_alikes.h"

#include "search/point_neighbors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Isometry3d;

namespace {

/** Modes that differ by more than this rotation [rad] do not look alike because a
 * structure repeats. */
constexpr double max_rotation = 0.2;

/** A cloud of which more than this share of the points fits is a part of the other. */
constexpr double least_of_a_part = 0.9;

/** The mean direction of a scan around its sensor is shorter than this. */
constexpr float max_mean_direction = 0.3F;

/** Rays within the first angle pass the same things, and a sensor has rays within the
 * second one of any direction that it looks in [rad]. */
constexpr float near_ray = 0.06F, far_ray = 0.1F;

/** A point beside a surface may be hidden if most of the nearest rays end before this
 * part of its distance. Where there is no surface, the sensor may have missed one
 * unless nearly all rays go on until the point is at this part of theirs. */
constexpr std::size_t num_rays = 6;
constexpr int least_shorter_rays = 4, least_longer_rays = 5;
constexpr float hiding_part = 0.95F;

/** Of a scan, at most one point in 20 is behind most of the rays around its own. They
 * end before this part of its distance. */
constexpr std::size_t num_rays_around = 12;
constexpr Index points_per_hidden_point = 20;
constexpr float own_hiding_part = 0.8F;

/** The rays from the origin of a cloud's frame to its points. */
class View {
public:
  /** \param[in] points 3 x n, finite [m] */
  explicit View(const Eigen::Matrix3Xd& points)
  : directions_(points.colwise().normalized().cast<float>())
  , ranges_(points.colwise().norm().cast<float>())
  , max_range_(ranges_.size() > 0 ? ranges_.maxCoeff() : 0.0F)
  , rays_(directions_)
  {}

  /** Whether a sensor at the origin may have seen all points, around itself. */
  bool
  isScanAroundOrigin() const
  {
    if (directions_.cols() == 0 ||
        directions_.rowwise().mean().norm() > max_mean_direction)
      return false;
    NeighborList list;
    Index num_hidden = 0;
    for (Index i = 0; i < directions_.cols(); ++i) {
      rays_.find(directions_.col(i), num_rays_around, list);
      const auto num_shorter = std::count_if(
          list.indices.begin(), list.indices.end(), [&](std::uint32_t ray) {
            return ranges_[ray] < own_hiding_part * ranges_[i];
          });
      num_hidden += 2 * num_shorter > static_cast<std::ptrdiff_t>(num_rays_around);
    }
    return points_per_hidden_point * num_hidden <= directions_.cols();
  }

  /** Whether the sensor may not have seen a point.
   * \param[in] has_patch whether it has seen a surface there
   * \param[in,out] list a buffer */
  bool
  mayMiss(const Eigen::Vector3d& point, bool has_patch, NeighborList& list) const
  {
    const auto range = static_cast<float>(point.norm());
    if (range > max_range_)
      return true;
    rays_.find(point.normalized().cast<float>(), num_rays, list);
    if (list.squared_distances.front() > far_ray * far_ray)
      return true;
    int num_shorter = 0, num_longer = 0;
    for (std::size_t k = 0; k < list.indices.size(); ++k) {
      const float of_ray = ranges_[list.indices[k]];
      const bool is_near = list.squared_distances[k] < near_ray * near_ray;
      num_shorter += is_near && of_ray < hiding_part * range;
      num_longer += is_near && range < hiding_part * of_ray;
    }
    return has_patch ? num_shorter >= least_shorter_rays
                     : num_longer < least_longer_rays;
  }

private:
  Eigen::Matrix3Xf directions_;
  Eigen::VectorXf ranges_; // [m]
  float max_range_;        // [m]
  PointNeighbors rays_;
};

bool
differByTranslations(const std::vector<CalibratedMode>& modes)
{
  const Eigen::Matrix3d front = modes.front().estimate.mode.linear();
  return std::all_of(modes.begin(), modes.end(), [&](const CalibratedMode& mode) {
    const Eigen::AngleAxisd turn(mode.estimate.mode.linear() * front.transpose());
    return turn.angle() <= max_rotation;
  });
}

bool
isPart(const CalibratedMode& mode)
{
  const ActiveShares active = activeSharesOf(mode.estimate.scores);
  return std::fmax(active.source, active.target) > least_of_a_part;
}

} // namespace

std::vector<std::vector<char>>
unseenPoints(const SurfaceScorer& scorer, const std::vector<CalibratedMode>& modes)
{
  if (modes.size() < 2 || !differByTranslations(modes) ||
      std::any_of(modes.begin(), modes.end(), isPart))
    return {};
  const View of_source(scorer.sourcePoints()), of_target(scorer.targetPoints());
  if (!of_source.isScanAroundOrigin() || !of_target.isScanAroundOrigin())
    return {};
  const Index num_source = scorer.sourcePoints().cols();
  std::vector<std::vector<char>> unseen;
  NeighborList of_source_list, of_target_list;
  for (const CalibratedMode& mode : modes) {
    const Isometry3d& pose = mode.estimate.mode;
    const Isometry3d inverse = pose.inverse();
    std::vector<char> of_mode;
    for (Index i = 0; i < scorer.numPoints(); ++i) {
      const auto point = static_cast<std::size_t>(i);
      const bool has_patch = mode.estimate.scores.has_patch[point];
      of_mode.push_back(
          !mode.estimate.scores.active[point] &&
          (i < num_source
               ? of_target.mayMiss(
                     pose * scorer.sourcePoints().col(i), has_patch, of_target_list)
               : of_source.mayMiss(inverse * scorer.targetPoints().col(i - num_source),
                                   has_patch,
                                   of_source_list)));
    }
    unseen.push_back(std::move(of_mode));
  }
  return unseen;
}

} // namespace bayesian_icp
