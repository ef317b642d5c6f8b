#include "calibrated/surface/depth_levels.h"

#include "calibrated/surface/even_choice.h"

#include <bayesian_icp/random.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Matrix3Xf;
using Eigen::Vector3d;

namespace {

/** The exact patches of rounded readings lie on at least so many levels (8 to 21 in
 * simulated scans), with as many points on each level of the cloud, on average, as a
 * neighbourhood has. CAD models have fewer parallel faces, or other points between
 * them.
 */
constexpr std::size_t min_levels = 6;
/** Levels are further apart than this fraction of spreadOf() the points, which is more
 * than the rounding of coordinates. */
constexpr double min_step_to_spread = 1e-5;
/** Random stream of the places of points on their levels; those of chains count from 0.
 */
constexpr std::uint64_t level_stream = std::uint64_t(1) << 42;
/** Cosine between the normals of patches that lie in levels. */
constexpr double min_parallelism = 1.0 - 1e-6;

/** Mean normal of the largest set of parallel patches, if these are more than half of
 * \p patches. */
std::optional<Vector3d>
commonNormal(const std::vector<SurfacePatch>& patches)
{
  std::size_t most = patches.size() / 2;
  std::optional<Vector3d> common;
  for (const SurfacePatch& patch : patches) {
    const Vector3d normal = patch.axes.col(2);
    Vector3d sum = Vector3d::Zero();
    std::size_t count = 0;
    for (const SurfacePatch& other : patches) {
      const double cosine = normal.dot(other.axes.col(2));
      if (std::abs(cosine) < min_parallelism)
        continue;
      sum += std::copysign(1.0, cosine) * other.axes.col(2);
      ++count;
    }
    if (count <= most)
      continue;
    most = count;
    common = sum.normalized();
  }
  return common;
}

/** Distance from the level of a place to the nearer one of the levels next to it [m].
 * \param[in] levels the lowest place of each level, ascending */
double
stepAt(double place, const std::vector<double>& levels)
{
  constexpr double none = std::numeric_limits<double>::infinity();
  const auto above = std::upper_bound(levels.begin(), levels.end(), place);
  const auto own = above - 1;
  return std::min(own == levels.begin() ? none : *own - *(own - 1),
                  above == levels.end() ? none : *above - *own);
}

/** The lowest of the places on each level, ascending. */
std::vector<double>
levelsOf(std::vector<double> places, double min_step)
{
  std::sort(places.begin(), places.end());
  const auto isSame = [min_step](double a, double b) { return b - a < min_step; };
  places.erase(std::unique(places.begin(), places.end(), isSame), places.end());
  return places;
}

} // namespace

std::optional<Matrix3Xf>
spreadLevels(const Matrix3Xf& points,
             const std::vector<SurfacePatch>& exact,
             int num_neighbors)
{
  const std::optional<Vector3d> axis = commonNormal(exact);
  if (!axis)
    return std::nullopt;
  std::vector<double> places(static_cast<std::size_t>(points.cols()));
  for (std::size_t i = 0; i < places.size(); ++i)
    places[i] = axis->dot(points.col(static_cast<Index>(i)).cast<double>());
  // One large face may have most points of a CAD model.
  std::vector<double> places_of_patches;
  for (const SurfacePatch& patch : exact)
    if (std::abs(axis->dot(patch.axes.col(2))) >= min_parallelism)
      places_of_patches.push_back(axis->dot(patch.centre));
  const double min_step = min_step_to_spread * spreadOf(points);
  const std::vector<double> levels = levelsOf(places, min_step);
  if (levelsOf(std::move(places_of_patches), min_step).size() < min_levels ||
      levels.size() * static_cast<std::size_t>(num_neighbors) > places.size())
    return std::nullopt;
  Random random(0, level_stream);
  Matrix3Xf spread = points;
  for (std::size_t i = 0; i < places.size(); ++i)
    spread.col(static_cast<Index>(i)) +=
        ((random.uniform() - 0.5) * stepAt(places[i], levels) * *axis).cast<float>();
  return spread;
}

} // namespace bayesian_icp
