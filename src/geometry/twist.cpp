#include "geometry/twist.h"

#include <Eigen/LU>

#include <cmath>

namespace bayesian_icp {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

Matrix3d
angleRates(const Vector6d& pose)
{
  constexpr double min_cos_pitch = 1e-6;
  const double cos_pitch = std::copysign(
      std::max(std::abs(std::cos(pose[4])), min_cos_pitch), std::cos(pose[4]));
  const double tan_pitch = std::sin(pose[4]) / cos_pitch;
  const double cos_yaw = std::cos(pose[5]), sin_yaw = std::sin(pose[5]);
  Matrix3d rates;
  rates << cos_yaw / cos_pitch, sin_yaw / cos_pitch, 0.0, // roll
      -sin_yaw, cos_yaw, 0.0,                             // pitch
      cos_yaw * tan_pitch, sin_yaw * tan_pitch, 1.0;      // yaw
  return rates;
}

namespace {

/** The pose, with those angles that the prior prefers of two triples. */
Vector6d
preferredPose(const Prior& prior, const Isometry3d& T_target_source)
{
  const Vector6d pose = poseOf(T_target_source.matrix());
  Vector6d other = pose;
  other.tail<3>() = Vector3d(pose[3] + M_PI, M_PI - pose[4], pose[5] + M_PI);
  const auto fit = [&](const Vector6d& angles) {
    const Vector3d d = angles.tail<3>() - prior.mean().tail<3>();
    return (d.array().cos() / prior.variance().tail<3>().array()).sum();
  };
  return fit(other) > fit(pose) ? other : pose;
}

/** The prior's deviation at a pose, and how it changes with twists. */
struct PriorDeviation {
  Vector6d deviation;
  /** d(deviation) / d(xi). */
  Matrix6d rates = Matrix6d::Identity();

  PriorDeviation(const Prior& prior,
                 const Isometry3d& T_target_source,
                 const Vector3d& centre)
  {
    const Vector6d pose = preferredPose(prior, T_target_source);
    deviation = prior.deviation(pose);
    // The prior speaks of the place of its reference point and of the angles.
    rates.topRightCorner<3, 3>() =
        -crossMatrix(T_target_source * prior.referencePoint() - centre);
    rates.bottomRightCorner<3, 3>() = angleRates(pose);
  }

  Vector6d
  gradient(const Prior& prior) const
  {
    Vector6d slope = deviation.cwiseQuotient(prior.variance());
    for (int k = 3; k < 6; ++k)
      slope[k] = std::sin(deviation[k]) / prior.variance()[k];
    return rates.transpose() * slope;
  }
};

/** Deviation of a pose from a plane in standard deviations: the distance of the point,
 * and the sine of the angle. */
struct PlaneDeviation {
  Eigen::Vector4d deviation;
  /** d(deviation) / d(xi). */
  Eigen::Matrix<double, 4, 6> rates = Eigen::Matrix<double, 4, 6>::Zero();

  PlaneDeviation(const PlaneHold& plane,
                 const Isometry3d& T_target_source,
                 const Vector3d& centre)
  {
    const Vector3d& normal = plane.target_normal;
    const Vector3d point = T_target_source * plane.source_point;
    const Vector3d tilted = T_target_source.linear() * plane.source_normal;
    deviation << normal.dot(point - plane.target_point) / plane.distance_sd,
        normal.cross(tilted) / plane.angle_sd;
    rates.row(0) << normal.transpose(), (point - centre).cross(normal).transpose();
    rates.row(0) /= plane.distance_sd;
    rates.bottomRightCorner<3, 3>() =
        (normal.dot(tilted) * Matrix3d::Identity() - tilted * normal.transpose()) /
        plane.angle_sd;
  }

  Vector6d
  gradient() const
  {
    return rates.transpose() * deviation;
  }
};

} // namespace

Isometry3d
movedBy(const Vector6d& xi, const Vector3d& centre, const Isometry3d& T_target_source)
{
  return Translation3d(centre) * Isometry3d(expSE3(xi)) * Translation3d(-centre) *
         T_target_source;
}

Vector6d
twistBetween(const Isometry3d& from, const Isometry3d& to, const Vector3d& centre)
{
  const Isometry3d motion =
      Translation3d(-centre) * to * from.inverse() * Translation3d(centre);
  return logSE3(motion.matrix());
}

Isometry3d
isometryOf(const Vector6d& pose)
{
  return Isometry3d(matrixOf(pose));
}

double
twistPriorEnergy(const HeldPrior& prior, const Isometry3d& T_target_source)
{
  double energy = prior.energy(preferredPose(prior, T_target_source));
  if (prior.plane)
    energy += 0.5 * PlaneDeviation(*prior.plane, T_target_source, Vector3d::Zero())
                        .deviation.squaredNorm();
  return energy;
}

Vector6d
twistPriorGradient(const HeldPrior& prior,
                   const Isometry3d& T_target_source,
                   const Vector3d& centre)
{
  Vector6d gradient = PriorDeviation(prior, T_target_source, centre).gradient(prior);
  if (prior.plane)
    gradient += PlaneDeviation(*prior.plane, T_target_source, centre).gradient();
  return gradient;
}

TwistPrior
twistPrior(const HeldPrior& prior,
           const Isometry3d& T_target_source,
           const Vector3d& centre)
{
  const PriorDeviation at(prior, T_target_source, centre);
  TwistPrior result;
  result.precision =
      at.rates.transpose() * prior.variance().cwiseInverse().asDiagonal() * at.rates;
  result.gradient = at.gradient(prior);
  if (prior.plane) {
    const PlaneDeviation out(*prior.plane, T_target_source, centre);
    result.precision += out.rates.transpose() * out.rates;
    result.gradient += out.gradient();
  }
  Vector6d wrapped = at.deviation;
  for (int k = 3; k < 6; ++k)
    wrapped[k] = wrapAngle(wrapped[k]);
  result.deviation = at.rates.partialPivLu().solve(wrapped);
  return result;
}

} // namespace bayesian_icp
