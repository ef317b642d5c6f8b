#include "options/enumerator_names.h"

#include <bayesian_icp/pose.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <cmath>
#include <limits>

namespace bayesian_icp {

namespace {

/** Coefficients (1 - cos a) / a^2 and (a - sin a) / a^3, with their series at a = 0. */
std::array<double, 2>
leftJacobianCoefficients(double angle)
{
  if (angle < 1e-2) { // the series is exact to 1e-17 there, the quotients are not
    const double a2 = angle * angle;
    return {{0.5 - a2 / 24.0 * (1.0 - a2 / 30.0 * (1.0 - a2 / 56.0)),
             1.0 / 6.0 - a2 / 120.0 * (1.0 - a2 / 42.0 * (1.0 - a2 / 72.0))}};
  }
  return {{(1.0 - std::cos(angle)) / (angle * angle),
           (angle - std::sin(angle)) / (angle * angle * angle)}};
}

/** V of exp(v, w) = (exp(w), V v). */
Eigen::Matrix3d
leftJacobianSO3(const Eigen::Vector3d& w)
{
  const auto c = leftJacobianCoefficients(w.norm());
  const Eigen::Matrix3d W = crossMatrix(w);
  return Eigen::Matrix3d::Identity() + c[0] * W + c[1] * W * W;
}

Eigen::Matrix4d
compose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation)
{
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = rotation;
  T.topRightCorner<3, 1>() = translation;
  return T;
}

Eigen::Matrix4d
inverseOf(const Eigen::Matrix4d& T)
{
  const Eigen::Matrix3d Rt = T.topLeftCorner<3, 3>().transpose();
  return compose(Rt, -Rt * T.topRightCorner<3, 1>());
}

Eigen::Matrix3d
nearestRotation(const Eigen::Matrix3d& m)
{
  // Next to a rotation, one step of Newton and Schulz is exact to the square of the
  // distance.
  const Eigen::Matrix3d stretch = m.transpose() * m;
  if ((stretch - Eigen::Matrix3d::Identity()).squaredNorm() < 1e-16 &&
      m.determinant() > 0.0)
    return m * (1.5 * Eigen::Matrix3d::Identity() - 0.5 * stretch);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(
      m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs(1.0, 1.0, 1.0);
  signs.z() = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1 : 1;
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

/** Roll, pitch, yaw of R = Rz Ry Rx; roll is 0 at gimbal lock. */
Eigen::Vector3d
anglesOf(const Eigen::Matrix3d& R)
{
  const double cos_pitch = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), cos_pitch);
  if (cos_pitch < 1e-12)
    return {0.0, pitch, std::atan2(-R(0, 1), R(1, 1))};
  return {std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))};
}

} // namespace

const char*
toString(CovarianceConvention convention)
{
  return nameOf(convention, {"parameters", "r3xso3", "left_se3", "right_se3"});
}

double
wrapAngle(double angle)
{
  const double wrapped = std::remainder(angle, 2.0 * M_PI);
  return wrapped <= -M_PI ? wrapped + 2.0 * M_PI : wrapped;
}

Vector6d
canonicalPose(const Vector6d& pose)
{
  Vector6d canonical = pose;
  if (std::abs(pose[4]) > 2.0 * M_PI) // the double of any number need not be one
    canonical[4] = wrapAngle(pose[4]);
  if (std::cos(canonical[4]) < 0.0)
    canonical.tail<3>() += Eigen::Vector3d(M_PI, M_PI - 2.0 * canonical[4], M_PI);
  for (int k = 3; k < 6; ++k)
    canonical[k] = wrapAngle(canonical[k]);
  return canonical;
}

Eigen::Matrix3d
rotationOf(const Vector6d& pose)
{
  const double cr = std::cos(pose[3]), sr = std::sin(pose[3]);
  const double cp = std::cos(pose[4]), sp = std::sin(pose[4]);
  const double cy = std::cos(pose[5]), sy = std::sin(pose[5]);
  Eigen::Matrix3d R;
  // clang-format off
  R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,
       sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,
           -sp,                cp * sr,                cp * cr;
  // clang-format on
  return R;
}

std::array<Eigen::Matrix3d, 3>
rotationDerivativesOf(const Vector6d& pose)
{
  // dR/dangle = [axis]x R: yaw turns about the fixed z axis, pitch about Rz e_y, roll
  // about Rz Ry e_x.
  const Eigen::Matrix3d R = rotationOf(pose);
  const double cy = std::cos(pose[5]), sy = std::sin(pose[5]);
  return {{crossMatrix(R.col(0)) * R,
           crossMatrix(Eigen::Vector3d(-sy, cy, 0.0)) * R,
           crossMatrix(Eigen::Vector3d::UnitZ()) * R}};
}

Eigen::Matrix4d
matrixOf(const Vector6d& pose)
{
  return compose(rotationOf(pose), pose.head<3>());
}

Vector6d
poseOf(const Eigen::Matrix4d& T_target_source)
{
  if (!T_target_source.allFinite())
    return Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
  Vector6d pose;
  pose << T_target_source.topRightCorner<3, 1>(),
      anglesOf(nearestRotation(T_target_source.topLeftCorner<3, 3>()));
  return pose;
}

Eigen::Matrix3d
crossMatrix(const Eigen::Vector3d& v)
{
  Eigen::Matrix3d cross;
  cross << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return cross;
}

Eigen::Matrix3d
expSO3(const Eigen::Vector3d& rotation_vector)
{
  const double angle = rotation_vector.norm();
  if (angle == 0.0)
    return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, rotation_vector / angle).toRotationMatrix();
}

Eigen::Vector3d
logSO3(const Eigen::Matrix3d& rotation)
{
  // Through the quaternion, which is well conditioned at 0 and near pi alike.
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0.0)
    q.coeffs() = -q.coeffs();
  const double sin_half = q.vec().norm();
  if (sin_half == 0.0)
    return Eigen::Vector3d::Zero();
  return 2.0 * std::atan2(sin_half, q.w()) / sin_half * q.vec();
}

Eigen::Matrix4d
expSE3(const Vector6d& twist)
{
  return compose(expSO3(twist.tail<3>()),
                 leftJacobianSO3(twist.tail<3>()) * twist.head<3>());
}

Vector6d
logSE3(const Eigen::Matrix4d& transform)
{
  Vector6d twist;
  const Eigen::Vector3d w = logSO3(transform.topLeftCorner<3, 3>());
  twist << leftJacobianSO3(w).inverse() * transform.topRightCorner<3, 1>(), w;
  return twist;
}

Vector6d
poseError(const Vector6d& pose, const Vector6d& mean, CovarianceConvention convention)
{
  Vector6d error = pose - mean;
  switch (convention) {
  case CovarianceConvention::Parameters:
    for (int k = 3; k < 6; ++k)
      error[k] = wrapAngle(error[k]);
    return error;
  case CovarianceConvention::R3xSO3:
    error.tail<3>() = logSO3(rotationOf(pose) * rotationOf(mean).transpose());
    return error;
  case CovarianceConvention::LeftSE3:
    return logSE3(matrixOf(pose) * inverseOf(matrixOf(mean)));
  case CovarianceConvention::RightSE3:
    return logSE3(inverseOf(matrixOf(mean)) * matrixOf(pose));
  }
  return error;
}

void
movePoints(const Vector6d& pose,
           const Eigen::Matrix3Xd& source_points,
           Eigen::Matrix3Xd& moved_points)
{
  moved_points.noalias() = rotationOf(pose) * source_points;
  moved_points.colwise() += pose.head<3>();
}

Vector6d
poseFromError(const Vector6d& error,
              const Vector6d& mean,
              CovarianceConvention convention)
{
  Vector6d pose = mean + error;
  switch (convention) {
  case CovarianceConvention::Parameters:
    for (int k = 3; k < 6; ++k)
      pose[k] = wrapAngle(pose[k]);
    return pose;
  case CovarianceConvention::R3xSO3:
    return poseOf(compose(expSO3(error.tail<3>()) * rotationOf(mean),
                          mean.head<3>() + error.head<3>()));
  case CovarianceConvention::LeftSE3:
    return poseOf(expSE3(error) * matrixOf(mean));
  case CovarianceConvention::RightSE3:
    return poseOf(matrixOf(mean) * expSE3(error));
  }
  return pose;
}

} // namespace bayesian_icp
