#include "calibrated/flat_clouds.h"

#include <bayesian_icp/random.h>

#include <Eigen/Cholesky>

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

/** How far the held motions are free, in units of the noise at a flat cloud's rim: far
 * less than any motion in the plane is known. */
constexpr double slack = 1e-5;

/** The pose that lays the source's plane onto the target's by the smallest rotation. */
Isometry3d
laidInPlane(const Isometry3d& T_target_source, const PlaneHold& plane)
{
  const Vector3d& normal = plane.target_normal;
  Vector3d tilted = T_target_source.linear() * plane.source_normal;
  if (tilted.dot(normal) < 0.0)
    tilted = -tilted;
  const Vector3d pivot = T_target_source * plane.source_point;
  Isometry3d laid = Isometry3d::Identity();
  laid.linear() =
      Eigen::Quaterniond::FromTwoVectors(tilted, normal).toRotationMatrix() *
      T_target_source.linear();
  laid.translation() = pivot - normal * normal.dot(pivot - plane.target_point) -
                       laid.linear() * plane.source_point;
  return laid;
}

/** Root mean square distance of the patches from their centroid [m]. */
double
radiusOf(const SurfaceModel& model)
{
  Vector3d sum = Vector3d::Zero();
  double squares = 0.0;
  for (const SurfacePatch& patch : model.patches()) {
    sum += patch.centre;
    squares += patch.centre.squaredNorm();
  }
  const auto count = static_cast<double>(model.patches().size());
  return std::sqrt(squares / count - (sum / count).squaredNorm());
}

/** The pose with a motion out of the plane: a shift along the normal, and tilts about
 * two axes of the source's plane through its point, one after the other. In the plane
 * of x and y these are pitch and roll, so the yaw does not change.
 * \param[in] normal_draw standard normal */
Isometry3d
movedOut(const Isometry3d& T_target_source,
         const Prior& prior,
         const PlaneHold& plane,
         const Vector3d& normal_draw)
{
  const Vector3d& normal = plane.source_normal;
  const Vector3d x = std::abs(normal.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY();
  const Vector3d first = (x - normal * normal.dot(x)).normalized();
  const Vector3d second = normal.cross(first);
  Eigen::Matrix<double, 6, 3> out = Eigen::Matrix<double, 6, 3>::Zero();
  out.col(0).head<3>() = plane.target_normal;
  out.col(1).tail<3>() = T_target_source.linear() * first;
  out.col(2).tail<3>() = T_target_source.linear() * second;
  const TwistPrior pull =
      twistPrior(prior, T_target_source, T_target_source * plane.source_point);
  // precision = U^T U, so U^-1 e has its inverse as covariance.
  const Eigen::LLT<Eigen::Matrix3d> precision(
      Eigen::Matrix3d(out.transpose() * pull.precision * out));
  const Vector3d motion = precision.matrixU().solve(normal_draw) -
                          precision.solve(Vector3d(out.transpose() * pull.gradient));
  const Eigen::Translation3d pivot(plane.source_point);
  return Eigen::Translation3d(motion[0] * plane.target_normal) * T_target_source *
         pivot * Eigen::AngleAxisd(motion[2], second) *
         Eigen::AngleAxisd(motion[1], first) * pivot.inverse();
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
  plane.distance_sd = slack * target.medianSigma();
  plane.angle_sd = plane.distance_sd / radiusOf(source);
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

} // namespace bayesian_icp
