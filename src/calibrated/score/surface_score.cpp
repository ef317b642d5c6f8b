#include "calibrated/score/surface_score.h"

#include "sampler/median.h"
#include "threads/for_each_piece.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace bayesian_icp {

using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

/** Residual of a point without a usable patch in meanCappedResidual(). */
constexpr double residual_cap = 5.0;

/** Smallest residualScale(). Smaller residuals mean that the target's noise is
 * overestimated. */
constexpr double min_residual_scale = 0.3;

/** Beyond its border, a surface may bend. Its slope is as uncertain as if one point
 * with the patch's noise had determined it. */
constexpr double slope_error = 2.0;

/** If a smaller fraction of the points has a patch, they do not show where the surface
 * continues. */
constexpr double min_contacts = 0.1;

/** Cosine of the smallest angle between a plane of rays and a surface that they meet.
 */
constexpr double max_cosine_of_rays = 0.9;

/** See SurfaceScorer::setSourceNoise(). */
constexpr double part_of_own_noise = 0.7;

/** Number of points that a thread of evaluate() takes at a time. */
constexpr Eigen::Index points_per_piece = 256;

/** The distance of one point to the surface of the other cloud. */
struct Contact {
  bool has_patch = false;
  /** u. */
  double residual = 0.0;
  /** n / sigma. */
  Vector3d normal = Vector3d::Zero();
  /** As in SurfaceScores. */
  double off_continuation = 1.0;
};

/** Energy of a point off the plane that touches a patch at its origin.
 * \param[in] in_plane its distance from there [m] */
double
energyOffPlane(const SurfacePatch& patch,
               const Vector3d& point,
               double in_plane,
               double min_sigma)
{
  const auto& a = patch.quadric;
  const Vector3d local = patch.axes.transpose() * (point - patch.origin);
  const double distance = local.z() - a[0] - a[1] * local.x() - a[2] * local.y();
  const double slopes = slope_error * in_plane / patch.radius;
  const double sigma =
      std::max(patch.sigma, min_sigma) * std::sqrt(1.0 + slopes * slopes);
  return tukeyEnergy(distance / (SurfaceScorer::tukey_constant * sigma));
}

/** See SurfaceScorer::setSourceNoise(). */
double
leastSigma(const SurfaceModel& model, const SurfaceModel& of_points)
{
  const double narrowing =
      std::min(1.0, model.medianRadius() / of_points.medianRadius());
  return std::max(0.0,
                  narrowing * of_points.medianSigma() -
                      part_of_own_noise * model.medianSigma());
}

/** \param[in] point in the model's frame
 * \param[in] ray_plane normal of the plane of the point's ray, or zero
 * \param[in] min_sigma as in SurfaceScorer::setSourceNoise() [m]
 * \param[in,out] hint nearest patch of the last time, and of this one */
Contact
contactWith(const SurfaceModel& model,
            const Vector3d& point,
            const Vector3d& ray_plane,
            double min_sigma,
            std::uint32_t& hint)
{
  Contact contact;
  const auto neighbor = model.tree().nearest(
      point.cast<float>(), std::numeric_limits<float>::infinity(), hint);
  hint = neighbor.index;
  if (neighbor.index == KdTree::none)
    return contact;
  const SurfacePatch& patch = model.patches()[neighbor.index];
  if (!patch.isUsable())
    return contact;
  const SurfaceOffset offset = offsetFrom(patch, point);
  if (std::abs(offset.normal.dot(ray_plane)) > max_cosine_of_rays)
    return contact;
  if (offset.in_plane > SurfaceScorer::max_in_plane * patch.radius) {
    contact.off_continuation = energyOffPlane(patch, point, offset.in_plane, min_sigma);
    return contact;
  }
  contact.has_patch = true;
  const double sigma = std::max(patch.sigma, min_sigma);
  contact.residual = offset.distance / sigma;
  contact.normal = offset.normal / sigma;
  return contact;
}

void
resize(SurfaceScores& scores, Eigen::Index num_points)
{
  scores.residuals.resize(num_points);
  scores.active.resize(static_cast<std::size_t>(num_points));
  scores.has_patch.resize(static_cast<std::size_t>(num_points));
  scores.off_continuation.resize(num_points);
  scores.scores.resize(6, num_points);
  scores.jacobians.resize(6, num_points);
}

} // namespace

/** Everything about a pose that is the same for all points. */
class SurfaceScorer::Placement {
public:
  Placement(const SurfaceScorer& scorer,
            const Isometry3d& T_target_source,
            const Vector3d& centre)
  : scorer_(scorer)
  , T_model_source_(Eigen::Translation3d(-scorer.model_.origin()) * T_target_source)
  , centre_in_model_(centre - scorer.model_.origin())
  , centre_(centre)
  , R_(T_target_source.linear())
  , ray_plane_(R_ * scorer.ray_plane_)
  {
    if (scorer.source_model_)
      T_source_model_target_ = Eigen::Translation3d(-scorer.source_model_->origin()) *
                               T_target_source.inverse();
  }

  /** \return whether the point has a patch, and its residual
   * \param[in] index of the point, in the order of SurfaceScores
   * \param[in,out] hint as in contactWith()
   * \param[out] rates J^T n / sigma: derivative of the residual with respect to a
   *             twist, if there is a patch */
  Contact
  contactOf(Eigen::Index index, std::uint32_t& hint, Vector6d& rates) const
  {
    const Eigen::Index num_source = scorer_.source_points_.cols();
    Contact contact;
    Vector3d arm;
    if (index < num_source) {
      const Vector3d point = T_model_source_ * scorer_.source_points_.col(index);
      contact =
          contactWith(scorer_.model_, point, ray_plane_, scorer_.min_sigma_, hint);
      arm = point - centre_in_model_;
    }
    else {
      const auto point = scorer_.target_points_.col(index - num_source);
      contact = contactWith(*scorer_.source_model_,
                            T_source_model_target_ * point,
                            Vector3d::Zero(),
                            scorer_.min_source_sigma_,
                            hint);
      // The surface moves, and the point does not: the opposite of the above.
      contact.normal = -(R_ * contact.normal);
      arm = point - centre_;
    }
    rates << contact.normal, arm.cross(contact.normal);
    return contact;
  }

private:
  const SurfaceScorer& scorer_;
  Isometry3d T_model_source_;
  Vector3d centre_in_model_, centre_;
  Eigen::Matrix3d R_;
  Vector3d ray_plane_;
  Isometry3d T_source_model_target_ = Isometry3d::Identity();
};

ActiveShares
activeSharesOf(const SurfaceScores& scores)
{
  const auto shareOf = [](int num_active, Eigen::Index num_points) {
    return num_active / static_cast<double>(num_points);
  };
  return {shareOf(scores.num_active_of_source, scores.num_source_points),
          shareOf(scores.num_active - scores.num_active_of_source,
                  scores.residuals.size() - scores.num_source_points)};
}

double
tukeyWeight(double z)
{
  return std::abs(z) < 1.0 ? (1.0 - z * z) * (1.0 - z * z) : 0.0;
}

double
tukeyEnergy(double z)
{
  const double rest = std::max(0.0, 1.0 - z * z);
  return 1.0 - rest * rest * rest;
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
  const Eigen::Index num_points =
      scores.num_source_points > 0 ? scores.num_source_points : scores.residuals.size();
  Eigen::VectorXd capped =
      scores.residuals.head(num_points).cwiseAbs().cwiseMin(residual_cap);
  for (Eigen::Index i = 0; i < capped.size(); ++i)
    if (!scores.has_patch[static_cast<std::size_t>(i)])
      capped[i] = std::numeric_limits<double>::quiet_NaN();
  return capped;
}

Contacts
contactsOf(const Eigen::VectorXd& capped_residuals)
{
  const auto has_patch = !capped_residuals.array().isNaN();
  const auto count = static_cast<double>(has_patch.count());
  return {count / static_cast<double>(capped_residuals.size()),
          has_patch.select(capped_residuals.array(), 0.0).sum() / count};
}

double
meanCappedResidual(const SurfaceScores& scores)
{
  const Eigen::VectorXd capped = cappedResiduals(scores);
  return capped.array().isNaN().select(residual_cap, capped).mean();
}

double
costOf(const SurfaceScores& scores)
{
  const Eigen::VectorXd capped = cappedResiduals(scores);
  const Contacts contacts = contactsOf(capped);
  const double least = contacts.share > 0.0 ? contacts.misfit : 0.0;
  const auto beyond =
      residual_cap * scores.off_continuation.head(capped.size()).array();
  return capped.array().isNaN().select(beyond.max(least), capped.array()).mean();
}

SurfaceScorer::SurfaceScorer(const Eigen::Matrix3Xd& source_points,
                             const SurfaceModel& model,
                             int num_threads)
: source_points_(source_points)
, centroid_(source_points.rowwise().mean())
, model_(model)
, num_threads_(num_threads)
, target_points_(3, 0)
{}

void
SurfaceScorer::addTargetPoints(const Eigen::Matrix3Xd& target_points,
                               const SurfaceModel& source_model)
{
  target_points_ = target_points;
  source_model_ = &source_model;
}

void
SurfaceScorer::setSourceNoise(const SurfaceModel& source_model)
{
  min_sigma_ = leastSigma(model_, source_model);
  min_source_sigma_ = leastSigma(source_model, model_);
}

SurfaceScorer::SurfaceScorer(const SurfaceScorer& all,
                             const Eigen::Matrix3Xd& source_points,
                             const Eigen::Matrix3Xd& target_points)
: source_points_(source_points)
, centroid_(all.centroid_)
, model_(all.model_)
, num_threads_(all.num_threads_)
, num_queries_(all.num_queries_)
, target_points_(target_points)
, source_model_(all.source_model_)
, min_sigma_(all.min_sigma_)
, min_source_sigma_(all.min_source_sigma_)
, ray_plane_(all.ray_plane_)
{}

SurfaceScorer
SurfaceScorer::ofFirst(Eigen::Index num_points) const
{
  const Eigen::Index num_of_target =
      source_points_.cols() > 0 ? 0 : std::min(num_points, target_points_.cols());
  return SurfaceScorer(
      *this,
      source_points_.leftCols(std::min(num_points, source_points_.cols())),
      target_points_.leftCols(num_of_target));
}

SurfaceScorer
SurfaceScorer::ofTarget() const
{
  return SurfaceScorer(*this, Eigen::Matrix3Xd(3, 0), target_points_);
}

SurfaceScorer
SurfaceScorer::ofFirstOfBoth(Eigen::Index num_points) const
{
  num_points = std::min(num_points, numPoints());
  const Eigen::Index num_of_target =
      num_points * target_points_.cols() / std::max(numPoints(), Eigen::Index(1));
  return SurfaceScorer(*this,
                       source_points_.leftCols(num_points - num_of_target),
                       target_points_.leftCols(num_of_target));
}

Eigen::Matrix3Xd
SurfaceScorer::pointsAt(const Isometry3d& T_target_source) const
{
  Eigen::Matrix3Xd points(3, numPoints());
  points.leftCols(source_points_.cols()) = source_points_;
  points.rightCols(target_points_.cols()) = T_target_source.inverse() * target_points_;
  return points;
}

void
SurfaceScorer::evaluate(const Isometry3d& T_target_source,
                        const Vector3d& centre,
                        double tau,
                        PatchHints& hints,
                        SurfaceScores& scores) const
{
  hints.resize(static_cast<std::size_t>(numPoints()), KdTree::none);
  resize(scores, numPoints());
  scores.num_source_points = source_points_.cols();
  countQueries(numPoints());
  const Placement placement(*this, T_target_source, centre);
  const auto evaluateAt = [&](Eigen::Index i) {
    const auto index = static_cast<std::size_t>(i);
    Vector6d rates;
    const Contact contact = placement.contactOf(i, hints[index], rates);
    const double weight =
        contact.has_patch
            ? tukeyWeight(contact.residual / tau / SurfaceScorer::tukey_constant)
            : 0.0;
    scores.has_patch[index] = contact.has_patch;
    scores.off_continuation[i] = contact.has_patch ? 0.0 : contact.off_continuation;
    scores.residuals[i] = contact.residual;
    scores.active[index] = weight > 0.0;
    scores.scores.col(i) = weight * contact.residual * rates;
    scores.jacobians.col(i) = std::sqrt(weight) * rates;
  };
  const Eigen::Index num_pieces =
      (numPoints() + points_per_piece - 1) / points_per_piece;
  forEachPiece(num_pieces, num_threads_, [&](std::ptrdiff_t piece) {
    const Eigen::Index begin = points_per_piece * piece;
    const Eigen::Index end = std::min(begin + points_per_piece, numPoints());
    for (Eigen::Index i = begin; i < end; ++i)
      evaluateAt(i);
  });
  const auto num_contacts =
      std::count(scores.has_patch.begin(), scores.has_patch.end(), true);
  if (static_cast<double>(num_contacts) <
      min_contacts * static_cast<double>(numPoints()))
    scores.off_continuation.setOnes();
  scores.total.setZero();
  scores.information.setZero();
  scores.num_active = scores.num_active_of_source = 0;
  for (Eigen::Index i = 0; i < numPoints(); ++i) {
    if (!scores.active[static_cast<std::size_t>(i)])
      continue;
    ++scores.num_active;
    scores.num_active_of_source += i < source_points_.cols();
    scores.total += scores.scores.col(i);
    const Vector6d jacobian = scores.jacobians.col(i);
    scores.information += jacobian.lazyProduct(jacobian.transpose());
  }
}

int
SurfaceScorer::batchScore(const Isometry3d& T_target_source,
                          const Vector3d& centre,
                          double tau,
                          const std::vector<std::size_t>& indices,
                          PatchHints& hints,
                          Vector6d& total) const
{
  hints.resize(static_cast<std::size_t>(numPoints()), KdTree::none);
  const Placement placement(*this, T_target_source, centre);
  total.setZero();
  int num_with_patch = 0;
  Vector6d rates;
  for (const std::size_t index : indices) {
    const Contact contact =
        placement.contactOf(static_cast<Eigen::Index>(index), hints[index], rates);
    if (!contact.has_patch)
      continue;
    ++num_with_patch;
    total += tukeyWeight(contact.residual / tau / SurfaceScorer::tukey_constant) *
             contact.residual * rates;
  }
  return num_with_patch;
}

} // namespace bayesian_icp
