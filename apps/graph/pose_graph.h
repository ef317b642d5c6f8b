/** \file
 * \brief Poses that are known to a covariance, and edges between them.
 */
#pragma once

#include <bayesian_icp/pose.h>

namespace bayesian_icp::app {

/** \brief In a radian. */
constexpr double degrees = 57.29577951308232;

/** \brief A pose that is known as well as its covariance says. */
struct GaussianPose {
  /** (x, y, z, roll, pitch, yaw) [m, rad]. */
  Vector6d mean = Vector6d::Zero();
  /** CovarianceConvention::RightSE3, in the frame of the scan [m, rad]. */
  Matrix6d covariance = Matrix6d::Zero();
};

/** \brief Part of the variance of registrations that all those with the same source
 * have in common: the noise of its points. Measured on simulated drives with three
 * sensors (docs/track.md); a target's noise is averaged over its surface, and
 * registrations with the same target have less in common. */
constexpr double source_share = 0.6;

/** \brief Factor of the variances of a registration with status Doubtful: its standard
 * deviations become three times as large. */
constexpr double doubt_factor = 9.0;

/** \brief The pose of one vertex as seen from another. */
struct GraphEdge {
  int target = 0;
  int source = 0;
  Eigen::Matrix4d T_target_source = Eigen::Matrix4d::Identity();
  /** CovarianceConvention::RightSE3 [m, rad]. */
  Matrix6d covariance = Matrix6d::Identity();
  /** Errors S^1/2 z of two edges with the same source are correlated: z of one and of
   * the other have the covariance sqrt(share share) times the identity. From 0,
   * independent of all others, to below 1. */
  double share = source_share;
};

} // namespace bayesian_icp::app
