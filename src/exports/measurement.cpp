#include "algebra/decompositions.h"
#include "geometry/principal_axes.h"
#include "geometry/twist.h"

#include <bayesian_icp/measurement.h>

namespace bayesian_icp {

namespace {

/** Of a prior that is infinitely wide [1/m^2, 1/rad^2]. */
constexpr double least_precision = 1e-12;

/** Derivative of the error about \p mean in one convention by that in another. */
Matrix6d
derivativeBetween(const Vector6d& mean,
                  CovarianceConvention from,
                  CovarianceConvention to)
{
  constexpr double step = 1e-5;
  Matrix6d derivative;
  for (int k = 0; k < 6; ++k) {
    const Vector6d error = step * Vector6d::Unit(k);
    const auto errorOf = [&](const Vector6d& given) {
      return poseError(poseFromError(given, mean, from), mean, to);
    };
    derivative.col(k) = (errorOf(error) - errorOf(-error)) / (2.0 * step);
  }
  return derivative;
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
    const Matrix6d converted = J * covariance * J.transpose();
    estimate.covariances[static_cast<std::size_t>(other)] =
        0.5 * (converted + converted.transpose());
  }
  return estimate;
}

PoseMeasurement
withoutPrior(const PoseEstimate& posterior, const Prior& prior)
{
  PoseMeasurement measurement;
  measurement.estimate.status = posterior.status;
  const Matrix6d& covariance = posterior.covariance(CovarianceConvention::LeftSE3);
  if (!posterior.mean.allFinite() || !covariance.allFinite() || !isUsable(prior)) {
    if (hasUsableMean(posterior.status))
      measurement.estimate.status = Status::InvalidInput;
    return measurement;
  }
  const TwistPrior near_mean =
      twistPrior(prior, isometryOf(posterior.mean), Eigen::Vector3d::Zero());
  // In units of the prior's the variance along an axis is 1 / (1 + lambda), lambda the
  // information of the clouds.
  const PrincipalAxes shares(
      covariance, near_mean.precision + least_precision * Matrix6d::Identity());
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
  measurement.estimate =
      estimateOf(poseFromError(shift, posterior.mean, CovarianceConvention::LeftSE3),
                 directions * variances.asDiagonal() * directions.transpose(),
                 CovarianceConvention::LeftSE3);
  measurement.estimate.status = status;
  return measurement;
}

PoseEstimate
estimateOf(const Prior& prior)
{
  const Matrix6d precision =
      twistPrior(prior, isometryOf(prior.mean()), Eigen::Vector3d::Zero()).precision +
      least_precision * Matrix6d::Identity();
  PoseEstimate estimate =
      estimateOf(prior.mean(), precision.inverse(), CovarianceConvention::LeftSE3);
  estimate.status = isUsable(prior) ? Status::Ok : Status::InvalidInput;
  return estimate;
}

} // namespace bayesian_icp
