#include "calibrated/flat_clouds.h"

#include "calibrated/surface/even_choice.h"

#include <bayesian_icp/random.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace bayesian_icp {

using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

/** First random stream of the motions out of the plane; those of chains count from 0.
 */
constexpr std::uint64_t first_stream = std::uint64_t(1) << 41;

/** Signs of the motions out of the plane in four chains, which are equal otherwise.
 * Over these chains their products are 0 on average. The mean rotation, to which
 * products of tilts add a turn in the plane, is then that of the plane. */
constexpr double signs[4][3] = {
    {1.0, 1.0, 1.0}, {1.0, -1.0, -1.0}, {-1.0, 1.0, -1.0}, {-1.0, -1.0, 1.0}};

/** How far the held motions are free, in units of the cloud's size or of the prior's
 * deviations: less than any motion in the plane is known, and as much as a double
 * resolves of the prior in a plane that is oblique to the axes. */
constexpr double slack = 1e-6;

/** Largest deviation of a tilt about which there is no doubt [rad]. Of 40 simulated
 * scans in a map, 11 ended tilted by half a radian where the prior's is 0.35, and one
 * where it is 0.1. */
constexpr double max_known_tilt = 0.1;

/** Newton's steps to the prior's mean out of the plane. A step from a tilt x leaves
 * x - sin(x) of it: after these, less than 1e-12 of a right angle. */
constexpr int num_steps_out = 5;

/** Axes of the tilts, in the source's plane. In the plane of x and y the tilts are roll
 * and pitch. */
struct TiltAxes {
  explicit TiltAxes(const Vector3d& normal)
  {
    const Vector3d x =
        std::abs(normal.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY();
    first = (x - normal * normal.dot(x)).normalized();
    second = normal.cross(first);
  }

  Vector3d first, second;
};

/** The pose without its motion out of the plane: a TiltedPose of the result is the
 * pose. In the plane of x and y the yaw stays as it is. */
Isometry3d
laidInPlane(const Isometry3d& T_target_source, const PlaneHold& plane)
{
  const TiltAxes axes(plane.source_normal);
  Vector3d up = T_target_source.linear().transpose() * plane.target_normal;
  if (up.dot(plane.source_normal) < 0.0)
    up = -up;
  const double side = up.dot(axes.second), height = up.dot(plane.source_normal);
  const Eigen::AngleAxisd first(std::atan2(side, height), axes.first);
  const Eigen::AngleAxisd second(
      -std::atan2(up.dot(axes.first), std::hypot(side, height)), axes.second);
  const Vector3d& normal = plane.target_normal;
  const Vector3d pivot = T_target_source * plane.source_point;
  Isometry3d laid = Isometry3d::Identity();
  laid.linear() = T_target_source.linear() * (second * first).inverse();
  laid.translation() = pivot - normal * normal.dot(pivot - plane.target_point) -
                       laid.linear() * plane.source_point;
  return laid;
}

/** A pose with a motion out of the plane: a shift along the normal, and tilts about two
 * axes of the source's plane through its point, one after the other. In the plane of x
 * and y these are pitch and roll, so the yaw does not change. */
struct TiltedPose {
  /** \param[in] motion shift [m], first and second tilt [rad] */
  TiltedPose(const Isometry3d& T_target_source,
             const PlaneHold& plane,
             const Vector3d& motion)
  {
    const TiltAxes axes(plane.source_normal);
    const Eigen::Translation3d pivot(plane.source_point);
    const Eigen::AngleAxisd first(motion[1], axes.first);
    const Eigen::AngleAxisd second(motion[2], axes.second);
    pose = Eigen::Translation3d(motion[0] * plane.target_normal) * T_target_source *
           pivot * second * first * pivot.inverse();
    rates.col(0).head<3>() = plane.target_normal;
    rates.col(1).tail<3>() = T_target_source.linear() * (second * axes.first);
    rates.col(2).tail<3>() = T_target_source.linear() * axes.second;
  }

  Isometry3d pose;
  /** d(xi) / d(motion), xi about the source's point. */
  Eigen::Matrix<double, 6, 3> rates = Eigen::Matrix<double, 6, 3>::Zero();
};

/** The pose with a motion out of the plane that comes from the prior.
 * \param[in] normal_draw standard normal */
Isometry3d
movedOut(const Isometry3d& T_target_source,
         const Prior& prior,
         const PlaneHold& plane,
         const Vector3d& normal_draw)
{
  Vector3d motion = Vector3d::Zero();
  Eigen::LLT<Eigen::Matrix3d> precision;
  for (int step = 0; step < num_steps_out; ++step) {
    const TiltedPose at(T_target_source, plane, motion);
    const TwistPrior pull = twistPrior(prior, at.pose, at.pose * plane.source_point);
    precision.compute(
        Eigen::Matrix3d(at.rates.transpose() * pull.precision * at.rates));
    motion -= precision.solve(Vector3d(at.rates.transpose() * pull.gradient));
  }
  // precision = U^T U, so U^-1 e has its inverse as covariance.
  motion += precision.matrixU().solve(normal_draw);
  return TiltedPose(T_target_source, plane, motion).pose;
}

} // namespace

HeldPrior
heldInPlane(const Prior& prior, const SurfaceModel& source, const SurfaceModel& target)
{
  if (!source.planeNormal() || !target.planeNormal())
    return prior;
  PlaneHold plane;
  plane.source_normal = *source.planeNormal();
  plane.target_normal = *target.planeNormal();
  plane.target_point = target.origin();
  const Vector3d aside = prior.referencePoint() - source.origin();
  plane.source_point =
      prior.referencePoint() - plane.source_normal * plane.source_normal.dot(aside);
  plane.distance_sd =
      slack * std::max(spreadOf(source.tree().points()),
                       std::sqrt(prior.variance().head<3>().maxCoeff()));
  plane.angle_sd = slack;
  const Isometry3d mean = laidInPlane(isometryOf(prior.mean()), plane);
  HeldPrior held(Prior(poseOf(mean.matrix()), prior.variance(), plane.source_point));
  held.plane = plane;
  return held;
}

void
addMotionOutOfPlane(const Prior& prior,
                    const HeldPrior& held,
                    std::uint64_t seed,
                    ChainSet& chains)
{
  std::uint64_t index = 0;
  for (Chain& chain : chains.chains) {
    Random random(seed, first_stream + index / 4);
    const Vector3d sign = Eigen::Map<const Vector3d>(signs[index++ % 4]);
    for (auto draw : chain.draws.rowwise()) {
      Vector3d normal_draw;
      for (double& coordinate : normal_draw)
        coordinate = random.normal();
      draw = poseOf(movedOut(isometryOf(draw.transpose()),
                             prior,
                             *held.plane,
                             sign.cwiseProduct(normal_draw))
                        .matrix())
                 .transpose();
    }
  }
}

bool
isOutOf(const PlaneHold& plane, const Vector6d& twist)
{
  const Vector3d v = twist.head<3>(), w = twist.tail<3>();
  const double v_out = plane.target_normal.dot(v), w_in = plane.target_normal.dot(w);
  return v_out * v_out >= 0.5 * v.squaredNorm() && w_in * w_in <= 0.5 * w.squaredNorm();
}

std::vector<std::string>
doubtsAboutTilt(const Prior& prior,
                const SurfaceModel& source,
                const SurfaceModel& target)
{
  if (!source.planeNormal() || target.planeNormal())
    return {};
  // A rotation about the normal is no tilt.
  const Eigen::Array3d tilted = 1.0 - source.planeNormal()->array().square();
  if ((tilted * prior.variance().tail<3>().array()).maxCoeff() <=
      max_known_tilt * max_known_tilt)
    return {};
  return {"the source lies in a plane and may fit the target with a wrong tilt: state "
          "how level it is (a prior of at most 0.1 rad)"};
}

} // namespace bayesian_icp
