/** \file
 * \brief How draws of the pose spread, seen at one point of the source, and the shapes
 * that show it.
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

/** \brief Semi-axes of the region (x - mean)^T covariance^-1 (x - mean) <= \p level:
 * the columns are orthogonal, longest first, in the unit of x. A direction without
 * variance has a column of zeros. */
Eigen::Matrix3d
regionAxes(const Eigen::Matrix3d& covariance, double level);

/** \brief What a body axis sweeps within a region of rotations.
 *
 * A small rotation w (about fixed axes, R = exp(w) R_mean) tips the unit vector
 * \p direction by w x direction. The columns of the result are the semi-axes of the
 * region of these tips, perpendicular to \p direction, longest first; their lengths are
 * angles [rad].
 * \param[in] level of the region of w, as in regionAxes */
Eigen::Matrix<double, 3, 2>
tipAxes(const Eigen::Matrix3d& rotation_covariance,
        const Eigen::Vector3d& direction,
        double level);

/** \brief A cone: its \p apex, and points all around its rim, which is \p direction
 * tipped along great circles by the ellipse of \p tip_axes, half a turn at most; \p
 * length [m] from apex to rim. Where one of the axes is zero it is a fan. */
Eigen::Matrix3Xd
coneOf(const Eigen::Vector3d& apex,
       const Eigen::Vector3d& direction,
       const Eigen::Matrix<double, 3, 2>& tip_axes,
       double length);

} // namespace bayesian_icp::viewer
