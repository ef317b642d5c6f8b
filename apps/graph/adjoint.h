/** \file
 * \brief Twists that are carried from one side of a pose to the other.
 */
#pragma once

#include <bayesian_icp/pose.h>

namespace bayesian_icp::app {

/** \brief Ad(T) of twists (v, w): T exp(xi) = exp(Ad(T) xi) T. With T.inverse() it
 * carries them from the left to the right. */
inline Matrix6d
adjointOf(const Eigen::Matrix4d& T)
{
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  Matrix6d adjoint;
  adjoint << R, crossMatrix(T.topRightCorner<3, 1>()) * R, Eigen::Matrix3d::Zero(), R;
  return adjoint;
}

} // namespace bayesian_icp::app
