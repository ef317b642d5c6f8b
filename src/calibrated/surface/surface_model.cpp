#include "calibrated/surface/surface_model.h"

#include "calibrated/surface/even_choice.h"
#include "calibrated/surface/surface_builder.h"
#include "search/finite_columns.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Matrix3Xf;
using Eigen::Vector3d;

namespace {

/** Points of neighbourhoods, for each patch. */
constexpr Index points_to_patches = 4;

} // namespace

SurfaceModel::SurfaceModel(const Matrix3Xd& target_points,
                           const SurfaceModelOptions& options,
                           int num_threads)
: origin_(Vector3d::Zero())
, tree_(Matrix3Xf(3, 0))
{
  Matrix3Xd finite = target_points(Eigen::all, finiteColumns(target_points));
  if (finite.cols() == 0)
    return;
  origin_ = finite.rowwise().mean();
  finite.colwise() -= origin_;
  const Matrix3Xf all = finite.cast<float>();
  const Matrix3Xf points = all(
      Eigen::all, evenlyThinned(all, points_to_patches * Index(options.max_patches)));
  SurfaceBuilder builder(points, options, num_threads);
  builder.fitPatches();
  builder.poolNoise();
  if (options.takeover_radius > 0.0)
    builder.takeOver();
  tree_ = KdTree(builder.projectedPoints(), num_threads);
  median_sigma_ = builder.medianSigma();
  spacing_ = builder.spacing();
  patches_ = builder.takePatches();
  const auto num_usable =
      std::count_if(patches_.begin(), patches_.end(), [](const SurfacePatch& p) {
        return p.isUsable();
      });
  usable_fraction_ =
      static_cast<double>(num_usable) / static_cast<double>(patches_.size());
}

} // namespace bayesian_icp
