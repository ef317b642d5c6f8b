#include "calibrated/surface/prepared_surface.h"

#include "calibrated/surface/even_choice.h"
#include "search/finite_columns.h"
#include "summary/plain_text.h"

#include <bayesian_icp/options.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Matrix3Xd;

namespace {

/** A target that is narrower than this, in standard deviations of the noise, is a line.
 * Patches fitted to its noise would hold motions along it. */
constexpr double min_width_to_noise = 3.0;

/** Standard deviation of the patches' points across the line that fits them best, where
 * they are widest [m]. */
double
widthOf(const SurfaceModel& model)
{
  Matrix3Xd centres(3, static_cast<Index>(model.patches().size()));
  for (Index i = 0; i < centres.cols(); ++i)
    centres.col(i) = model.patches()[static_cast<std::size_t>(i)].centre;
  centres.colwise() -= centres.rowwise().mean().eval();
  const Eigen::Matrix3d covariance =
      centres * centres.transpose() / static_cast<double>(centres.cols());
  const double variance =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly)
          .eigenvalues()[1];
  return std::sqrt(std::max(variance, 0.0));
}

/** Why distances to the target's surface are meaningless; empty if they are valid. */
std::string
complaintAbout(const SurfaceModel& model)
{
  if (!(model.usableFraction() > 0.0))
    return "the target has no usable surface: its points are too noisy, too sparse or "
           "too tangled for distances to a surface";
  const double width = widthOf(model);
  if (width < min_width_to_noise * model.medianSigma())
    return formatted("the target has no surface: it is a line to within %.2g m, %.1f "
                     "times its noise (at least %.0f)",
                     width,
                     width / model.medianSigma(),
                     min_width_to_noise);
  return std::string();
}

PreparedSurface
withoutSurface(Status status,
               const std::string& complaint,
               const std::vector<Index>& columns)
{
  return {SurfaceModel(Matrix3Xd(3, 0)), complaint, status, columns};
}

/** Those of the finite columns of \p points that are not stray. */
std::vector<Index>
usedColumns(const Matrix3Xd& points,
            const std::vector<Index>& finite,
            const SurfaceModelOptions& options)
{
  std::vector<Index> used = withoutStray(
      relativeTo(centroidOf(points, finite), points, finite), options.maxPoints());
  for (Index& column : used)
    column = finite[static_cast<std::size_t>(column)];
  return used;
}

} // namespace

PreparedSurface
prepareSurface(const Matrix3Xd& points, int num_threads, int num_doublings)
{
  const std::vector<Index> finite = finiteColumns(points);
  if (finite.size() < std::size_t(min_calibrated_points))
    return withoutSurface(Status::InvalidInput,
                          "the target has " + std::to_string(finite.size()) +
                              " finite points, but preset calibrated needs " +
                              std::to_string(min_calibrated_points),
                          finite);
  SurfaceModelOptions options;
  options.max_patches <<= num_doublings;
  std::vector<Index> columns = usedColumns(points, finite, options);
  PreparedSurface surface = {
      SurfaceModel(points, columns, options, num_threads), {}, {}, std::move(columns)};
  if (surface.model.patches().size() < std::size_t(min_calibrated_points))
    return withoutSurface(Status::TooFewCorrespondences,
                          "the target has no surface: only " +
                              std::to_string(surface.model.patches().size()) +
                              " of its points differ and are not stray",
                          finite);
  surface.complaint = complaintAbout(surface.model);
  if (!surface.complaint.empty())
    surface.status = Status::TooFewCorrespondences;
  return surface;
}

} // namespace bayesian_icp
