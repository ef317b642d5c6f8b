/** \file
 * \brief The pose, its matrix, its derivatives, and every convention of the project.
 *
 * A pose is theta = (x, y, z, roll, pitch, yaw) in metres and radians. It maps source
 * points into the target frame, p = R s + u with u = (x, y, z) in the target frame and
 * R = Rz(yaw) Ry(pitch) Rx(roll) about the origin of the source frame.
 * A twist or pose error is always ordered translation first, then rotation.
 */
#pragma once

#include <bayesian_icp/export.h>

#include <Eigen/Core>

#include <array>

namespace bayesian_icp {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/** \brief Poses, one a row: (number of draws) x 6, columns x y z roll pitch yaw. */
using PoseMatrix = Eigen::Matrix<double, Eigen::Dynamic, 6>;

/** \brief The coordinates in which a 6x6 covariance is expressed. Units are metres and
 * radians, order is translation first in all of them. */
enum class CovarianceConvention {
  /** (x, y, z, roll, pitch, yaw), the paper's parameters. */
  Parameters,
  /** Position error in the target frame, and a small rotation w about the target's
   * fixed axes: R = exp(w) R_mean, t = t_mean + dt. The meaning of ROS
   * PoseWithCovariance. */
  R3xSO3,
  /** T = exp(xi) T_mean, xi = (v, w) in the target frame. */
  LeftSE3,
  /** T = T_mean exp(xi), xi = (v, w) in the source (body) frame. GTSAM's, which in
   * addition puts the rotation first. */
  RightSE3
};

/** \brief All of them, in their order. */
constexpr std::array<CovarianceConvention, 4> covariance_conventions = {
    {CovarianceConvention::Parameters,
     CovarianceConvention::R3xSO3,
     CovarianceConvention::LeftSE3,
     CovarianceConvention::RightSE3}};

/** \brief Short name of a convention: "parameters", "r3xso3", "left_se3", "right_se3".
 */
BAYESIAN_ICP_EXPORT const char*
toString(CovarianceConvention convention);

/** \brief The angle brought to (-pi, pi] [rad]. */
BAYESIAN_ICP_EXPORT double
wrapAngle(double angle);

/** \brief The same rotation and position with |pitch| <= pi/2 and angles in (-pi, pi].
 */
BAYESIAN_ICP_EXPORT Vector6d
canonicalPose(const Vector6d& pose);

/** \brief R = Rz(yaw) Ry(pitch) Rx(roll) of a pose. */
BAYESIAN_ICP_EXPORT Eigen::Matrix3d
rotationOf(const Vector6d& pose);

/** \brief dR/droll, dR/dpitch, dR/dyaw, in this order (used in eq. 3 of the paper). */
BAYESIAN_ICP_EXPORT std::array<Eigen::Matrix3d, 3>
rotationDerivativesOf(const Vector6d& pose);

/** \brief The homogeneous matrix T_target_source of a pose. */
BAYESIAN_ICP_EXPORT Eigen::Matrix4d
matrixOf(const Vector6d& pose);

/** \brief The canonical pose of a homogeneous matrix. Its rotation block is first
 * brought to the nearest rotation, so float round-off does no harm; at gimbal lock
 * (|pitch| = pi/2) roll is 0. Non-finite input gives a pose of NaN. */
BAYESIAN_ICP_EXPORT Vector6d
poseOf(const Eigen::Matrix4d& T_target_source);

/** \brief The matrix [v]x with [v]x a = v x a. */
BAYESIAN_ICP_EXPORT Eigen::Matrix3d
crossMatrix(const Eigen::Vector3d& v);

/** \brief exp: R^3 -> SO(3), rotation vector [rad] to matrix. */
BAYESIAN_ICP_EXPORT Eigen::Matrix3d
expSO3(const Eigen::Vector3d& rotation_vector);

/** \brief log: SO(3) -> R^3, the rotation vector with norm in [0, pi]. */
BAYESIAN_ICP_EXPORT Eigen::Vector3d
logSO3(const Eigen::Matrix3d& rotation);

/** \brief exp: se(3) -> SE(3) of a twist (v, w). */
BAYESIAN_ICP_EXPORT Eigen::Matrix4d
expSE3(const Vector6d& twist);

/** \brief log: SE(3) -> se(3), the twist (v, w). */
BAYESIAN_ICP_EXPORT Vector6d
logSE3(const Eigen::Matrix4d& transform);

/** \brief The error of \p pose relative to \p mean in the given convention: the vector
 * whose second moment over draws is the covariance of that convention. Angles are
 * wrapped about the mean. */
BAYESIAN_ICP_EXPORT Vector6d
poseError(const Vector6d& pose, const Vector6d& mean, CovarianceConvention convention);

/** \brief The inverse of poseError: the pose that has \p error relative to \p mean. */
BAYESIAN_ICP_EXPORT Vector6d
poseFromError(const Vector6d& error,
              const Vector6d& mean,
              CovarianceConvention convention);

} // namespace bayesian_icp
