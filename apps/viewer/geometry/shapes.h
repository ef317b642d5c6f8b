/** \file
 * \brief Regions of a Gaussian as shapes.
 */
#pragma once

#include <Eigen/Core>

namespace bayesian_icp::viewer {

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
