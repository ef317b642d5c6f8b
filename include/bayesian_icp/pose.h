/** \file
 * \brief The pose, its matrix, its derivatives, and all conventions of the project.
 *
 * A pose is theta = (x, y, z, roll, pitch, yaw) in metres and radians. It maps source
 * points into the target frame: p = R s + u, with u = (x, y, z) in the target frame and
 * R = Rz(yaw) Ry(pitch) Rx(roll) about the origin of the source frame. Twists and pose
 * errors always have translation first, then rotation.
 */
#pragma once

#include <bayesian_icp/export.h>

#include <Eigen/Core>

#include <array>

namespace bayesian_icp {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/** \brief Poses: (number of draws) x 6. Each row is one pose; the columns are x y z
 * roll pitch yaw. */
using PoseMatrix = Eigen::Matrix<double, Eigen::Dynamic, 6>;

/** \brief The coordinates of a 6x6 covariance. In all of them units are metres and
 * radians, and translation comes first. */
enum class CovarianceConvention {
  /** (x, y, z, roll, pitch, yaw), the paper's parameters. */
  Parameters,
  /** Position error in the target frame, and a small rotation w about the target's
   * fixed axes: R = exp(w) R_mean, t = t_mean + dt. This is the convention of ROS
   * PoseWithCovariance. */
  R3xSO3,
  /** T = exp(xi) T_mean, xi = (v, w) in the target frame. */
  LeftSE3,
  /** T = T_mean exp(xi), xi = (v, w) in the source (body) frame. GTSAM uses it with
   * rotation first. */
  RightSE3
};

/** \brief All conventions, in their order. */
constexpr std::array<CovarianceConvention, 4> covariance_conventions = {
    {CovarianceConvention::Parameters,
     CovarianceConvention::R3xSO3,
     CovarianceConvention::LeftSE3,
     CovarianceConvention::RightSE3}};

/** \brief Short name of a convention: "parameters", "r3xso3", "left_se3", "right_se3".
 */
BAYESIAN_ICP_EXPORT const char*
toString(CovarianceConvention convention);

/** \brief Wrap an angle to (-pi, pi] [rad]. */
BAYESIAN_ICP_EXPORT double
wrapAngle(double angle);

/** \brief The pose with the same rotation and position, |pitch| <= pi/2 and angles in
 * (-pi, pi]. */
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

/** \brief The canonical pose of a homogeneous matrix.
 *
 * The rotation block is first replaced by the nearest rotation, so float round-off does
 * no harm. At gimbal lock (|pitch| = pi/2) roll is 0. Non-finite input gives a pose of
 * NaN. */
BAYESIAN_ICP_EXPORT Vector6d
poseOf(const Eigen::Matrix4d& T_target_source);

/** \brief Move source points into the target frame: column i is R s_i + u [m]. */
BAYESIAN_ICP_EXPORT void
movePoints(const Vector6d& pose,
           const Eigen::Matrix3Xd& source_points,
           Eigen::Matrix3Xd& moved_points);

/** \brief The matrix [v]x with [v]x a = v x a. */
BAYESIAN_ICP_EXPORT Eigen::Matrix3d
crossMatrix(const Eigen::Vector3d& v);

/** \brief exp: R^3 -> SO(3). Converts a rotation vector [rad] to a matrix. */
BAYESIAN_ICP_EXPORT Eigen::Matrix3d
expSO3(const Eigen::Vector3d& rotation_vector);

/** \brief log: SO(3) -> R^3. The rotation vector has a norm in [0, pi]. */
BAYESIAN_ICP_EXPORT Eigen::Vector3d
logSO3(const Eigen::Matrix3d& rotation);

/** \brief exp: se(3) -> SE(3) of a twist (v, w). */
BAYESIAN_ICP_EXPORT Eigen::Matrix4d
expSE3(const Vector6d& twist);

/** \brief log: SE(3) -> se(3), the twist (v, w). */
BAYESIAN_ICP_EXPORT Vector6d
logSE3(const Eigen::Matrix4d& transform);

/** \brief The error of \p pose relative to \p mean in the given convention. The second
 * moment of this vector over the draws is the covariance of that convention. Angles
 * are wrapped about the mean. */
BAYESIAN_ICP_EXPORT Vector6d
poseError(const Vector6d& pose, const Vector6d& mean, CovarianceConvention convention);

/** \brief The inverse of poseError: the pose that has \p error relative to \p mean,
 * angles in (-pi, pi]. In convention Parameters its pitch may be beyond pi/2. */
BAYESIAN_ICP_EXPORT Vector6d
poseFromError(const Vector6d& error,
              const Vector6d& mean,
              CovarianceConvention convention);

} // namespace bayesian_icp
