#include "median.h"
#include "patch_fit.h"

#include <bayesian_icp/calibration/surface_model.h>
#include <bayesian_icp/first_exception.h>
#include <bayesian_icp/random.h>

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Matrix3Xf;
using Eigen::Vector3d;

namespace {

/** Patches over which the noise is pooled. */
constexpr std::size_t num_pooled = 12;
/** Neighbours among which a point at an edge looks for a patch to take over, and how
 * far off its surface it may be, in the donor's noise. */
constexpr std::size_t num_donors = 32;
constexpr double max_takeover_residual = 2.5;
/** Smallest sigma of a patch: in units of the median, and of the spacing for targets
 * without noise. */
constexpr double min_sigma_to_median = 0.3;
constexpr double min_sigma_to_spacing = 1e-4;

Matrix3Xd
finiteColumns(const Matrix3Xd& points)
{
  Matrix3Xd finite(3, points.cols());
  Index count = 0;
  for (Index i = 0; i < points.cols(); ++i)
    if (points.col(i).allFinite())
      finite.col(count++) = points.col(i);
  finite.conservativeResize(3, count);
  return finite;
}

/** Columns that get a patch: all, or \p max_patches chosen at random, ascending. */
std::vector<Index>
chosenColumns(Index num_points, Index max_patches)
{
  if (num_points <= max_patches) {
    std::vector<Index> columns(static_cast<std::size_t>(num_points));
    std::iota(columns.begin(), columns.end(), Index(0));
    return columns;
  }
  Random random(1, 0);
  std::vector<Index> columns = randomChoice(num_points, max_patches, random);
  std::sort(columns.begin(), columns.end());
  return columns;
}

/** The stages of building a model. */
class Builder {
public:
  /** \param[in] points 3 x n, finite, relative to the model's origin [m] */
  Builder(const Matrix3Xf& points, const SurfaceModelOptions& options, int num_threads)
  : options_(options)
  , num_threads_(num_threads > 0 ? num_threads : omp_get_max_threads())
  , points_(points)
  , columns_(chosenColumns(points.cols(), options.max_patches))
  , patches_(columns_.size())
  , spacings_(columns_.size())
  {}

  void
  fitPatches()
  {
    const PointNeighbors cloud(points_);
    const auto count = static_cast<std::ptrdiff_t>(columns_.size());
#pragma omp parallel num_threads(num_threads_)
    {
      PatchFitWorkspace workspace;
#pragma omp for schedule(dynamic, 64)
      for (std::ptrdiff_t j = 0; j < count; ++j)
        failure_.guard([&] {
          const auto patch = static_cast<std::size_t>(j);
          patches_[patch] = fitPatch(cloud,
                                     points_.col(columns_[patch]),
                                     options_,
                                     workspace,
                                     spacings_[patch]);
        });
    }
    failure_.rethrow();
  }

  /** Noise of a patch: root mean square over the usable ones around it. */
  void
  poolNoise(const PointNeighbors& centres)
  {
    std::vector<double> pooled(patches_.size());
    const auto count = static_cast<std::ptrdiff_t>(patches_.size());
#pragma omp parallel num_threads(num_threads_)
    {
      PatchFitWorkspace workspace;
#pragma omp for schedule(dynamic, 64)
      for (std::ptrdiff_t j = 0; j < count; ++j)
        failure_.guard([&] {
          centres.find(centres.points().col(j),
                       num_pooled,
                       workspace.indices,
                       workspace.squared_distances);
          double sum = 0.0;
          int used = 0;
          for (const auto index : workspace.indices)
            if (patches_[index].is_usable) {
              sum += patches_[index].sigma * patches_[index].sigma;
              ++used;
            }
          const auto patch = static_cast<std::size_t>(j);
          pooled[patch] = used > 0 ? std::sqrt(sum / used) : patches_[patch].sigma;
        });
    }
    failure_.rethrow();
    std::vector<double> usable;
    for (std::size_t j = 0; j < patches_.size(); ++j)
      if (patches_[j].is_usable)
        usable.push_back(pooled[j]);
    median_sigma_ = medianOf(usable.empty() ? pooled : usable);
    const double least =
        std::max({min_sigma_to_median * median_sigma_,
                  min_sigma_to_spacing * spacing(),
                  static_cast<double>(std::numeric_limits<float>::min())});
    for (std::size_t j = 0; j < patches_.size(); ++j)
      patches_[j].sigma = std::max(pooled[j], least);
    median_sigma_ = std::max(median_sigma_, least);
  }

  /** Points at edges take over the patch of a neighbour whose surface they lie on. */
  void
  takeOver(const PointNeighbors& centres)
  {
    std::vector<std::uint32_t> donors(patches_.size(), KdTree::none);
    const auto count = static_cast<std::ptrdiff_t>(patches_.size());
#pragma omp parallel num_threads(num_threads_)
    {
      PatchFitWorkspace workspace;
#pragma omp for schedule(dynamic, 64)
      for (std::ptrdiff_t j = 0; j < count; ++j)
        if (!patches_[static_cast<std::size_t>(j)].is_usable)
          failure_.guard([&] {
            donors[static_cast<std::size_t>(j)] = donorOf(
                patches_[static_cast<std::size_t>(j)].centre, centres, workspace);
          });
    }
    failure_.rethrow();
    // Donors are usable, so none of them is overwritten.
    for (std::size_t j = 0; j < patches_.size(); ++j)
      if (donors[j] != KdTree::none) {
        const Vector3d centre = patches_[j].centre;
        patches_[j] = patches_[donors[j]];
        patches_[j].centre = centre;
      }
  }

  /** The patches' points, on their quadrics. */
  Matrix3Xf
  projectedPoints() const
  {
    Matrix3Xf projected(3, static_cast<Index>(patches_.size()));
    for (std::size_t j = 0; j < patches_.size(); ++j) {
      const SurfaceOffset offset = offsetFrom(patches_[j], patches_[j].centre);
      projected.col(static_cast<Index>(j)) =
          (patches_[j].centre - offset.distance * offset.normal).cast<float>();
    }
    return projected;
  }

  Matrix3Xf
  centrePoints() const
  {
    Matrix3Xf centres(3, static_cast<Index>(columns_.size()));
    for (std::size_t j = 0; j < columns_.size(); ++j)
      centres.col(static_cast<Index>(j)) = points_.col(columns_[j]);
    return centres;
  }

  std::vector<SurfacePatch>
  takePatches()
  {
    return std::move(patches_);
  }

  double
  medianSigma() const
  {
    return median_sigma_;
  }

  double
  spacing() const
  {
    return medianOf(spacings_);
  }

private:
  std::uint32_t
  donorOf(const Vector3d& centre,
          const PointNeighbors& centres,
          PatchFitWorkspace& workspace) const
  {
    centres.find(centre.cast<float>(),
                 num_donors,
                 workspace.indices,
                 workspace.squared_distances);
    std::uint32_t best = KdTree::none;
    double best_rank = std::numeric_limits<double>::infinity();
    for (const auto index : workspace.indices) {
      const SurfacePatch& donor = patches_[index];
      if (!donor.is_usable)
        continue;
      const SurfaceOffset offset = offsetFrom(donor, centre);
      const double residual = std::abs(offset.distance) / donor.sigma;
      if (residual > max_takeover_residual ||
          offset.in_plane > options_.takeover_radius * donor.radius)
        continue;
      const double rank = offset.in_plane / donor.radius + 0.2 * residual;
      if (rank < best_rank) {
        best_rank = rank;
        best = index;
      }
    }
    return best;
  }

  const SurfaceModelOptions& options_;
  int num_threads_;
  const Matrix3Xf& points_;
  std::vector<Index> columns_;
  std::vector<SurfacePatch> patches_;
  std::vector<double> spacings_;
  FirstException failure_;
  double median_sigma_ = 0.0;
};

} // namespace

SurfaceOffset
offsetFrom(const SurfacePatch& patch, const Vector3d& point)
{
  const auto& a = patch.quadric;
  const Vector3d local = patch.axes.transpose() * (point - patch.origin);
  const double x = local.x(), y = local.y();
  const double height =
      a[0] + a[1] * x + a[2] * y + a[3] * x * x + a[4] * x * y + a[5] * y * y;
  const double slope_x = a[1] + 2.0 * a[3] * x + a[4] * y;
  const double slope_y = a[2] + a[4] * x + 2.0 * a[5] * y;
  const double length = std::sqrt(1.0 + slope_x * slope_x + slope_y * slope_y);
  SurfaceOffset offset;
  offset.distance = (local.z() - height) / length;
  offset.normal = patch.axes * Vector3d(-slope_x, -slope_y, 1.0) / length;
  const Vector3d from_centre = patch.axes.transpose() * (point - patch.centre);
  offset.in_plane = std::max(local.head<2>().norm(), from_centre.head<2>().norm());
  return offset;
}

SurfaceModel::SurfaceModel(const Matrix3Xd& target_points,
                           const SurfaceModelOptions& options,
                           int num_threads)
: origin_(Vector3d::Zero())
, tree_(Matrix3Xf(3, 0))
{
  Matrix3Xd finite = finiteColumns(target_points);
  if (finite.cols() == 0)
    return;
  origin_ = finite.rowwise().mean();
  finite.colwise() -= origin_;
  const Matrix3Xf points = finite.cast<float>();
  Builder builder(points, options, num_threads);
  builder.fitPatches();
  const Matrix3Xf centre_points = builder.centrePoints();
  const PointNeighbors centres(centre_points);
  builder.poolNoise(centres);
  if (options.takeover_radius > 0.0)
    builder.takeOver(centres);
  tree_ = KdTree(builder.projectedPoints(), num_threads);
  median_sigma_ = builder.medianSigma();
  spacing_ = builder.spacing();
  patches_ = builder.takePatches();
  const auto num_usable =
      std::count_if(patches_.begin(), patches_.end(), [](const SurfacePatch& p) {
        return p.is_usable;
      });
  usable_fraction_ =
      static_cast<double>(num_usable) / static_cast<double>(patches_.size());
}

} // namespace bayesian_icp
