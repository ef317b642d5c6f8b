#include "localization/stated_pose.h"

#include "io/numbers.h"

#include <bayesian_icp/measurement.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>

namespace bayesian_icp::app {

namespace {

/** How far the length of a quaternion may be from 1: programs that keep three digits.
 */
constexpr double quaternion_tolerance = 1e-2;
/** Closer than this to a pitch of +-pi/2, roll and yaw are no coordinates [rad]. */
constexpr double min_distance_to_gimbal_lock = 1e-2;
/** Least eigenvalue of a correlation matrix, for rounding of the numbers in messages.
 */
constexpr double least_eigenvalue = -1e-6;
/** Largest difference between a correlation and that across the diagonal. */
constexpr double symmetry_tolerance = 1e-3;
/** Of covariances, by their largest variance. */
constexpr double rounding = 1e-12;
/** In a covariance, so that products of its numbers do not overflow. */
constexpr double largest_number = 1e100;

Vector6d
meanOf(const StatedPose& pose)
{
  if (!pose.position.allFinite() || !pose.orientation.coeffs().allFinite())
    throw Refusal("the prior's pose is not finite");
  const double length = pose.orientation.norm();
  if (std::abs(length - 1.0) > quaternion_tolerance)
    throw Refusal("the prior's orientation is a quaternion of length " +
                  io::textOf(length) + ", but the length must be 1");
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = pose.orientation.normalized().toRotationMatrix();
  T.translation() = pose.position;
  const Vector6d mean = poseOf(T.matrix());
  if (std::abs(std::cos(mean[4])) < min_distance_to_gimbal_lock)
    throw Refusal("the prior's pitch is " + io::textOf(mean[4]) +
                  " rad: at +-pi/2 roll and yaw have no separate variances");
  return mean;
}

/** Divided by the standard deviations of its rows and columns. */
Matrix6d
correlationsOf(const Matrix6d& covariance)
{
  const Vector6d scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * covariance * scale.asDiagonal();
}

/** \return the symmetric part, with the floor */
Matrix6d
checkedCovariance(const Matrix6d& stated, const PriorFloor& floor)
{
  static constexpr std::array<const char*, 6> axes = {
      "x", "y", "z", "rotation about x", "rotation about y", "rotation about z"};
  Matrix6d covariance = 0.5 * (stated + stated.transpose());
  for (Eigen::Index k = 0; k < 6; ++k)
    if (covariance(k, k) < 0.0)
      throw Refusal("the prior's variance of " + std::string(axes[k]) + " is " +
                    io::textOf(covariance(k, k)) + ", but must be positive");
  for (Eigen::Index k = 0; k < 6; ++k) {
    const double least = k < 3 ? floor.translation : floor.rotation;
    covariance(k, k) = std::max(covariance(k, k), least * least);
  }
  if (!(covariance.array().abs() <= largest_number).all())
    throw Refusal("the prior's covariance is not finite, or beyond " +
                  io::textOf(largest_number) + " (m^2, rad^2)");
  for (Eigen::Index k = 0; k < 6; ++k)
    if (!(covariance(k, k) > 0.0))
      throw Refusal("the prior's variance of " + std::string(axes[k]) +
                    " is 0, but must be positive; the parameters prior_floor_m and "
                    "prior_floor_rad set minimum standard deviations");
  const Vector6d deviations = covariance.diagonal().cwiseSqrt();
  const Eigen::Array<double, 6, 6> largest =
      symmetry_tolerance * deviations * deviations.transpose();
  const double rounded = rounding * covariance.diagonal().maxCoeff();
  if (((stated - stated.transpose()).array() > largest + rounded).any())
    throw Refusal("the prior's covariance is not symmetric");
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(correlationsOf(covariance),
                                                       Eigen::EigenvaluesOnly);
  if (!(solver.eigenvalues()[0] >= least_eigenvalue))
    throw Refusal("the prior's covariance is not positive semi-definite: its "
                  "correlations have the eigenvalue " +
                  io::textOf(solver.eigenvalues()[0]));
  return covariance;
}

} // namespace

StatedPose
statedPoseOf(const Vector6d& mean, const Matrix6d& right_se3)
{
  StatedPose stated;
  stated.position = mean.head<3>();
  stated.orientation = rotationOf(mean);
  stated.covariance = estimateOf(mean, right_se3, CovarianceConvention::RightSE3)
                          .covariance(CovarianceConvention::R3xSO3);
  return stated;
}

StatedPrior
priorFrom(const StatedPose& pose, const PriorFloor& floor)
{
  PriorOptions prior;
  prior.mean = meanOf(pose);
  prior.frame = PriorFrame::Origin;
  const Matrix6d covariance = estimateOf(prior.mean,
                                         checkedCovariance(pose.covariance, floor),
                                         CovarianceConvention::R3xSO3)
                                  .covariance(CovarianceConvention::Parameters);
  // By Gershgorin's theorem, the difference to the stated covariance has no negative
  // eigenvalue.
  const Vector6d factors = correlationsOf(covariance).cwiseAbs().rowwise().sum();
  prior.variance = covariance.diagonal().cwiseProduct(factors);
  return {prior, std::max(1.0, factors.maxCoeff())};
}

} // namespace bayesian_icp::app
