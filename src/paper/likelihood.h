/** \file
 * \brief Energy and gradient for given correspondences, as pure functions of the pose.
 */
#pragma once

#include <bayesian_icp/correspondence.h>
#include <bayesian_icp/pose.h>

namespace bayesian_icp {

/** \brief Mean energy of a mini-batch, (1/m) sum |R s_i + u - q_i|^2 / 2 [m^2]: half of
 * eq. (1). m is the number of columns. Points without a correspondence count as zero.
 */
double
meanEnergy(const Vector6d& pose,
           const Eigen::Matrix3Xd& source_points,
           const Correspondences& correspondences);

/** \brief Mean gradient of a mini-batch, eqs. (2) and (3), with respect to (x, y, z,
 * roll, pitch, yaw) [m, m^2/rad]. It is the gradient of meanEnergy at fixed
 * correspondences.
 * \param[in] pose at which the gradient is taken [m, rad]
 * \param[in] source_points 3 x m, source frame [m]
 * \param[in] moved_points 3 x m, the same points in the target frame [m]
 * \param[in] correspondences of the moved points */
Vector6d
meanGradient(const Vector6d& pose,
             const Eigen::Matrix3Xd& source_points,
             const Eigen::Matrix3Xd& moved_points,
             const Correspondences& correspondences);

} // namespace bayesian_icp
