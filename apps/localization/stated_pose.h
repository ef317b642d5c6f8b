/** \file
 * \brief A pose with covariance as ROS states it, and the prior that is made of it.
 */
#pragma once

#include <bayesian_icp/pose.h>
#include <bayesian_icp/prior.h>

#include <Eigen/Geometry>

#include <cstdint>
#include <stdexcept>
#include <string>

namespace bayesian_icp::app {

/** \brief An input that cannot be used; the message says which and why. */
struct Refusal : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/** \brief A geometry_msgs/PoseWithCovarianceStamped in plain numbers. */
struct StatedPose {
  /** The frame in which the pose is stated. */
  std::string frame;
  std::int64_t stamp_ns = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero(); // [m]
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  /** CovarianceConvention::R3xSO3: x, y, z, then rotations about the fixed axes x, y, z
   * of the frame [m, rad]. */
  Matrix6d covariance = Matrix6d::Zero();
};

/** \brief A pose in the library's coordinates as priorFrom() takes it.
 * \param[in] mean pose [m, rad]
 * \param[in] right_se3 CovarianceConvention::RightSE3 */
StatedPose
statedPoseOf(const Vector6d& mean, const Matrix6d& right_se3);

/** \brief Least standard deviations of a prior, for sources that leave elements of the
 * covariance at zero: a planar filter those of z, roll and pitch. */
struct PriorFloor {
  double translation = 0.0; // [m]
  double rotation = 0.0;    // [rad]
};

/** \brief A prior that is made of a stated pose. */
struct StatedPrior {
  PriorOptions options;
  /** Largest factor of a variance for its correlations, at least 1. */
  double widening = 1.0;
};

/** \brief The prior that a stated pose makes.
 *
 * The library's priors have independent x, y, z, roll, pitch, yaw. The covariance is
 * converted to these coordinates. If it has no correlations there, its variances are
 * the prior's. If it has, each variance is multiplied by the sum of the absolute
 * correlations in its row, which makes the prior wider than the stated one in every
 * direction.
 * \throws Refusal with the reason if the pose is not finite, the quaternion has no
 * length of 1, pitch is within 0.01 rad of +-pi/2, or the covariance is not finite, has
 * numbers beyond 1e100, is not symmetric, not positive semi-definite or has a variance
 * that is not positive and has no floor */
StatedPrior
priorFrom(const StatedPose& pose, const PriorFloor& floor = PriorFloor());

} // namespace bayesian_icp::app
