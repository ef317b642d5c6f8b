#include "calibrated/score/surface_score.h"

#include "calibrated/median.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp {

using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

/** Residual of a point without a usable patch in meanCappedResidual(). */
constexpr double residual_cap = 5.0;

/** Smallest residualScale(): below, the target's noise is overestimated. */
constexpr double min_residual_scale = 0.3;

/** J^T n: derivative of a distance along n with respect to a twist. */
Vector6d
distanceRates(const Vector3d& normal, const Vector3d& arm)
{
  Vector6d rates;
  rates << normal, arm.cross(normal);
  return rates;
}

/** The distance of one moved point to the surface. */
struct Contact {
  bool has_patch = false;
  /** u. */
  double residual = 0.0;
  /** J^T n / sigma. */
  Vector6d rates = Vector6d::Zero();
};

/** Everything about a pose that is the same for all points. */
struct Placement {
  Placement(const SurfaceModel& surface,
            const Isometry3d& T_target_source,
            const Vector3d& centre)
  : model(surface)
  , T_model_source(Eigen::Translation3d(-surface.origin()) * T_target_source)
  , centre_in_model(centre - surface.origin())
  {}

  /** \param[in,out] hint nearest patch of the last time, and of this one */
  Contact
  contactOf(const Vector3d& source_point, std::uint32_t& hint) const
  {
    Contact contact;
    const Vector3d point = T_model_source * source_point;
    const auto neighbor = model.tree().nearest(
        point.cast<float>(), std::numeric_limits<float>::infinity(), hint);
    hint = neighbor.index;
    if (neighbor.index == KdTree::none)
      return contact;
    const SurfacePatch& patch = model.patches()[neighbor.index];
    if (!patch.isUsable())
      return contact;
    const SurfaceOffset offset = offsetFrom(patch, point);
    if (offset.in_plane > SurfaceScorer::max_in_plane * patch.radius)
      return contact;
    contact.has_patch = true;
    contact.residual = offset.distance / patch.sigma;
    contact.rates = distanceRates(offset.normal, point - centre_in_model) / patch.sigma;
    return contact;
  }

  const SurfaceModel& model;
  Isometry3d T_model_source;
  Vector3d centre_in_model;
};

void
clear(SurfaceScores& scores, Eigen::Index num_points)
{
  scores.residuals.setZero(num_points);
  scores.active.assign(static_cast<std::size_t>(num_points), 0);
  scores.has_patch.assign(static_cast<std::size_t>(num_points), 0);
  scores.scores.setZero(6, num_points);
  scores.jacobians.setZero(6, num_points);
  scores.total.setZero();
  scores.information.setZero();
  scores.num_active = 0;
}

} // namespace

double
tukeyWeight(double z)
{
  return std::abs(z) < 1.0 ? (1.0 - z * z) * (1.0 - z * z) : 0.0;
}

double
residualScale(const SurfaceScores& scores)
{
  std::vector<double> magnitudes;
  for (std::size_t i = 0; i < scores.has_patch.size(); ++i)
    if (scores.has_patch[i])
      magnitudes.push_back(std::abs(scores.residuals[static_cast<Eigen::Index>(i)]));
  if (magnitudes.empty())
    return 1.0;
  // 1.4826: the median magnitude of a standard normal variate is 1 / 1.4826.
  return std::max(min_residual_scale, 1.4826 * medianOf(std::move(magnitudes)));
}

Eigen::VectorXd
cappedResiduals(const SurfaceScores& scores)
{
  Eigen::VectorXd capped = scores.residuals.cwiseAbs().cwiseMin(residual_cap);
  for (std::size_t i = 0; i < scores.has_patch.size(); ++i)
    if (!scores.has_patch[i])
      capped[static_cast<Eigen::Index>(i)] = std::numeric_limits<double>::quiet_NaN();
  return capped;
}

double
meanCappedResidual(const SurfaceScores& scores)
{
  const Eigen::VectorXd capped = cappedResiduals(scores);
  return capped.array().isNaN().select(residual_cap, capped).mean();
}

SurfaceScorer::SurfaceScorer(const Eigen::Matrix3Xd& source_points,
                             const SurfaceModel& model)
: source_points_(source_points)
, centroid_(source_points.rowwise().mean())
, model_(model)
{}

SurfaceScorer
SurfaceScorer::ofFirst(Eigen::Index num_points) const
{
  SurfaceScorer first(
      source_points_.leftCols(std::min(num_points, source_points_.cols())), model_);
  first.centroid_ = centroid_;
  return first;
}

void
SurfaceScorer::evaluate(const Isometry3d& T_target_source,
                        const Vector3d& centre,
                        double tau,
                        PatchHints& hints,
                        SurfaceScores& scores) const
{
  const Eigen::Index num_points = source_points_.cols();
  hints.resize(static_cast<std::size_t>(num_points), KdTree::none);
  clear(scores, num_points);
  const Placement placement(model_, T_target_source, centre);
  for (Eigen::Index i = 0; i < num_points; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const Contact contact = placement.contactOf(source_points_.col(i), hints[index]);
    if (!contact.has_patch)
      continue;
    scores.has_patch[index] = 1;
    scores.residuals[i] = contact.residual;
    const double weight =
        tukeyWeight(contact.residual / tau / SurfaceScorer::tukey_constant);
    if (weight == 0.0)
      continue;
    scores.active[index] = 1;
    ++scores.num_active;
    scores.scores.col(i) = weight * contact.residual * contact.rates;
    scores.jacobians.col(i) = std::sqrt(weight) * contact.rates;
    scores.total += scores.scores.col(i);
    scores.information.selfadjointView<Eigen::Lower>().rankUpdate(
        scores.jacobians.col(i));
  }
  scores.information = Matrix6d(scores.information.selfadjointView<Eigen::Lower>());
}

int
SurfaceScorer::batchScore(const Isometry3d& T_target_source,
                          const Vector3d& centre,
                          double tau,
                          const std::vector<std::size_t>& indices,
                          PatchHints& hints,
                          Vector6d& total) const
{
  hints.resize(static_cast<std::size_t>(source_points_.cols()), KdTree::none);
  const Placement placement(model_, T_target_source, centre);
  total.setZero();
  int num_with_patch = 0;
  for (const std::size_t index : indices) {
    const Contact contact = placement.contactOf(
        source_points_.col(static_cast<Eigen::Index>(index)), hints[index]);
    if (!contact.has_patch)
      continue;
    ++num_with_patch;
    total += tukeyWeight(contact.residual / tau / SurfaceScorer::tukey_constant) *
             contact.residual * contact.rates;
  }
  return num_with_patch;
}

} // namespace bayesian_icp
