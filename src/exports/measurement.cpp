#include "algebra/decompositions.h"
#include "geometry/principal_axes.h"
#include "geometry/twist.h"

#include <bayesian_icp/measurement.h>

#include <cmath>

namespace bayesian_icp {

using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

/** Of a prior that is infinitely wide [1/m^2, 1/rad^2]. */
constexpr double least_precision = 1e-12;

/** Derivative of a twist about the point at \p offset by the same twist about the
 * origin: v' = v + w x offset. */
Matrix6d
twistsAbout(const Vector3d& offset)
{
  Matrix6d derivative = Matrix6d::Identity();
  derivative.topRightCorner<3, 3>() = -crossMatrix(offset);
  return derivative;
}

/** Derivative of a twist of the target's axes about a point of the source by one of the
 * source's about its origin. */
Matrix6d
aboutPoint(const Isometry3d& T_target_source, const Vector3d& source_point)
{
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() =
      T_target_source.linear();
  return turn * twistsAbout(source_point);
}

/** Derivative of an R3xSO3 error, a twist about the mean position, by that in another
 * convention. */
Matrix6d
r3xSO3By(const Vector6d& mean, CovarianceConvention from)
{
  Matrix6d derivative = Matrix6d::Identity();
  if (from == CovarianceConvention::Parameters) {
    // Roll turns about the source's x axis, yaw about the target's z axis.
    derivative.block<3, 1>(3, 3) = rotationOf(mean).col(0);
    derivative.block<3, 1>(3, 4) << -std::sin(mean[5]), std::cos(mean[5]), 0.0;
  }
  if (from == CovarianceConvention::LeftSE3)
    derivative = twistsAbout(mean.head<3>());
  if (from == CovarianceConvention::RightSE3)
    derivative = aboutPoint(isometryOf(mean), Vector3d::Zero());
  return derivative;
}

/** Derivative of the error about \p mean in one convention by that in another. */
Matrix6d
derivativeBetween(const Vector6d& mean,
                  CovarianceConvention from,
                  CovarianceConvention to)
{
  if (from == to)
    return Matrix6d::Identity();
  const Matrix6d first = r3xSO3By(mean, from);
  if (to != CovarianceConvention::Parameters)
    return r3xSO3By(mean, to).inverse() * first;
  Matrix6d second = Matrix6d::Identity();
  second.bottomRightCorner<3, 3>() = angleRates(mean);
  return second * first;
}

bool
isUsable(const Prior& prior)
{
  return prior.mean().allFinite() && prior.referencePoint().allFinite() &&
         (prior.variance().array() > 0.0).all();
}

} // namespace

PoseEstimate
estimateOf(const Vector6d& mean,
           const Matrix6d& covariance,
           CovarianceConvention convention)
{
  PoseEstimate estimate;
  estimate.mean = mean;
  for (const auto other : covariance_conventions) {
    const Matrix6d J = derivativeBetween(mean, convention, other);
    estimate.covariances[static_cast<std::size_t>(other)] =
        symmetrized(J * covariance * J.transpose());
  }
  return estimate;
}

PoseMeasurement
withoutPrior(const PoseEstimate& posterior, const Prior& prior)
{
  PoseMeasurement measurement;
  measurement.estimate.status = posterior.status;
  const Matrix6d& of_source = posterior.covariance(CovarianceConvention::RightSE3);
  if (!posterior.mean.allFinite() || !of_source.allFinite() || !isUsable(prior)) {
    if (hasUsableMean(posterior.status))
      measurement.estimate.status = Status::InvalidInput;
    return measurement;
  }
  // Twists about the prior's point, which is near the source wherever the origins are.
  const Isometry3d pose = isometryOf(posterior.mean);
  const TwistPrior near_mean = twistPrior(prior, pose, pose * prior.referencePoint());
  const Matrix6d to_point = aboutPoint(pose, prior.referencePoint());
  const Matrix6d from_point = to_point.inverse();
  const Matrix6d covariance = to_point * of_source * to_point.transpose();
  // In units of the prior's the variance along an axis is 1 / (1 + lambda), lambda the
  // information of the clouds.
  const PrincipalAxes shares(
      covariance, near_mean.precision + least_precision * Matrix6d::Identity());
  // But for rounding errors.
  if (shares.variances.minCoeff() < -1e-9) {
    measurement.estimate.status = Status::InvalidInput;
    return measurement;
  }
  const Matrix6d& directions = shares.axes;
  Vector6d variances, gains;
  measurement.num_unmeasured = 0;
  for (int k = 0; k < 6; ++k) {
    const double share = shares.variances[k];
    const bool is_measured =
        share < max_measured_share_of_prior * max_measured_share_of_prior;
    const double variance = share / (1.0 - share);
    variances[k] = is_measured ? variance : unmeasured_deviation * unmeasured_deviation;
    gains[k] = is_measured ? variance : 0.0;
    measurement.num_unmeasured += is_measured ? 0 : 1;
  }
  // At the posterior's mode the gradient of the likelihood is minus the prior's.
  const Vector6d shift =
      directions * gains.cwiseProduct(directions.transpose() * near_mean.gradient);
  const Status status = measurement.estimate.status;
  const Matrix6d axes = from_point * directions;
  measurement.estimate = estimateOf(
      poseFromError(from_point * shift, posterior.mean, CovarianceConvention::RightSE3),
      axes * variances.asDiagonal() * axes.transpose(),
      CovarianceConvention::RightSE3);
  measurement.estimate.status = status;
  return measurement;
}

PoseEstimate
estimateOf(const Prior& prior)
{
  const Isometry3d pose = isometryOf(prior.mean());
  const Matrix6d precision =
      twistPrior(prior, pose, pose * prior.referencePoint()).precision +
      least_precision * Matrix6d::Identity();
  const Matrix6d from_point = aboutPoint(pose, prior.referencePoint()).inverse();
  PoseEstimate estimate =
      estimateOf(prior.mean(),
                 from_point * precision.inverse() * from_point.transpose(),
                 CovarianceConvention::RightSE3);
  estimate.status = isUsable(prior) ? Status::Ok : Status::InvalidInput;
  return estimate;
}

} // namespace bayesian_icp
