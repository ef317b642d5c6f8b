/** \file
 * \brief How draws of the pose spread, seen at one point of the source.
 *
 * The position in a pose is that of the source frame's origin, which may be far from
 * the object. Seen at the object's centroid, position and rotation are what the eye
 * expects.
 */
#pragma once

#include <bayesian_icp/pose.h>

namespace bayesian_icp::viewer {

/** \brief chi^2 quantile of 95 % for 3 degrees of freedom. */
constexpr double chi_squared_95_percent_3_dof = 7.814727903251179;

/** \brief Mean and covariance of draws at a reference point. */
struct PoseSpread {
  /** Source frame [m]. */
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();
  /** Position of the reference in the target frame, and angles [m, rad]. */
  Vector6d mean = Vector6d::Zero();
  /** CovarianceConvention::R3xSO3 about the mean [m, rad]. */
  Matrix6d covariance = Matrix6d::Zero();

  Eigen::Vector3d
  position() const
  {
    return mean.head<3>();
  }

  /** \brief Standard deviations along the position's principal axes, largest first [m].
   */
  Eigen::Vector3d
  positionDeviations() const;

  /** \brief Standard deviations about the rotation's principal axes, largest first
   * [rad]. */
  Eigen::Vector3d
  rotationDeviations() const;

  /** \brief T_target_source of the mean. */
  Eigen::Matrix4d
  meanMatrix() const;
};

/** \brief The spread of at least two \p draws (source frame's origin, one in each row)
 * at \p reference. */
PoseSpread
spreadAt(const Eigen::Vector3d& reference, const PoseMatrix& draws);

/** \brief T_target_source of a draw whose error about the mean (R3xSO3) is \p factor
 * times what it is. */
Eigen::Matrix4d
magnified(const Vector6d& draw, const PoseSpread& spread, double factor);

/** \brief Standard deviation of each point under the draws: root of the summed
 * variances of its three coordinates [m], exact for all draws.
 * \param[in] points source frame [m], one in each column
 * \param[in] draws at least two */
Eigen::VectorXd
pointDeviations(const Eigen::Matrix3Xd& points, const PoseMatrix& draws);

} // namespace bayesian_icp::viewer
