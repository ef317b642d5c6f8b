#include "calibrated/surface/prepared_surface.h"

#include "search/finite_columns.h"
#include "summary/plain_text.h"

#include <bayesian_icp/options.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Matrix3Xd;

namespace {

/** A target that is narrower than this, in standard deviations of the noise, is a line.
 * Patches that are fitted to its noise would hold motions along it. */
constexpr double min_width_to_noise = 3.0;

/** The \p columns of different points, each the first of its kind, in their order. */
std::vector<Index>
distinctColumns(const Matrix3Xd& points, const std::vector<Index>& columns)
{
  const auto hashOf = [&points](Index column) {
    std::size_t hash = 0; // Zeros of both signs are equal, and so are their hashes.
    for (int k = 0; k < 3; ++k)
      hash = (hash ^ std::hash<double>()(points(k, column))) * 0x9e3779b97f4a7c15;
    return hash ^ hash >> 32;
  };
  std::size_t size = 1;
  while (size < 2 * columns.size())
    size *= 2;
  constexpr Index none = -1;
  std::vector<Index> slots(size, none), distinct;
  for (const Index column : columns) {
    std::size_t slot = hashOf(column) & (size - 1);
    while (slots[slot] != none && points.col(slots[slot]) != points.col(column))
      slot = (slot + 1) & (size - 1);
    if (slots[slot] != none)
      continue;
    slots[slot] = column;
    distinct.push_back(column);
  }
  return distinct;
}

/** Standard deviation of the points across the line that fits them best, where they are
 * widest [m]. */
double
widthOf(const Matrix3Xd& points)
{
  const Matrix3Xd centred = points.colwise() - points.rowwise().mean();
  const Eigen::Matrix3d covariance =
      centred * centred.transpose() / static_cast<double>(points.cols());
  const double variance =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly)
          .eigenvalues()[1];
  return std::sqrt(std::max(variance, 0.0));
}

/** Why distances to the target's surface mean nothing; empty if they do. */
std::string
complaintAbout(const SurfaceModel& model, const Matrix3Xd& points)
{
  if (!(model.usableFraction() > 0.0))
    return "the target has no usable surface: its points are too noisy, too sparse or "
           "too tangled for distances to a surface";
  if (!(model.medianSigma() > 0.0))
    return "the target's points lie on their surface exactly: without noise there is "
           "no scale";
  const double width = widthOf(points);
  if (width < min_width_to_noise * model.medianSigma())
    return formatted("the target has no surface: it is a line to within %.2g m, %.1f "
                     "times its noise (at least %.0f)",
                     width,
                     width / model.medianSigma(),
                     min_width_to_noise);
  return std::string();
}

PreparedSurface
withoutSurface(Status status, const std::string& complaint)
{
  return {SurfaceModel(Matrix3Xd(3, 0)), complaint, status};
}

} // namespace

PreparedSurface
prepareSurface(const Matrix3Xd& points, int num_threads)
{
  const std::vector<Index> finite = finiteColumns(points);
  if (finite.size() < std::size_t(min_calibrated_points))
    return withoutSurface(Status::InvalidInput,
                          "the target has " + std::to_string(finite.size()) +
                              " finite points, but preset calibrated needs " +
                              std::to_string(min_calibrated_points));
  const Matrix3Xd distinct_points = points(Eigen::all, distinctColumns(points, finite));
  if (distinct_points.cols() < min_calibrated_points)
    return withoutSurface(Status::TooFewCorrespondences,
                          "the target has no surface: only " +
                              std::to_string(distinct_points.cols()) +
                              " of its points differ");
  PreparedSurface surface = {
      SurfaceModel(distinct_points, SurfaceModelOptions(), num_threads), {}, {}};
  surface.complaint = complaintAbout(surface.model, distinct_points);
  if (!surface.complaint.empty())
    surface.status = Status::TooFewCorrespondences;
  return surface;
}

} // namespace bayesian_icp
