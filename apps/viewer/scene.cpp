#include "viewer/scene.h"

#include <bayesian_icp/random.h>

#include <Eigen/Geometry>

#include <algorithm>

namespace bayesian_icp::viewer {

namespace {

void
append(const Eigen::Matrix3Xd& more, Eigen::Matrix3Xd& points)
{
  points.conservativeResize(3, points.cols() + more.cols());
  points.rightCols(more.cols()) = more;
}

} // namespace

std::optional<Uncertainty>
uncertaintyOf(const Scene& scene, const ViewOptions& options)
{
  if (scene.draws.rows() < 2)
    return std::nullopt;
  Uncertainty result;
  const Eigen::Vector3d reference = options.reference == Reference::Centroid
                                        ? centroidOf(scene.source)
                                        : Eigen::Vector3d::Zero();
  result.spread = spreadAt(reference, scene.draws);
  result.point_deviations = pointDeviations(scene.source, scene.draws);
  for (const double deviation : result.point_deviations) // NaN is not larger
    if (deviation > result.largest_point_deviation)
      result.largest_point_deviation = deviation;
  result.magnification =
      options.magnification > 0.0
          ? options.magnification
          : niceMagnification(std::max(result.largest_point_deviation,
                                       result.spread.positionDeviations()[0]),
                              sizeOf(scene.source));
  for (const Eigen::Index draw : evenlySpaced(scene.draws.rows(), options.num_draws))
    result.shown_draws.push_back(magnified(
        scene.draws.row(draw).transpose(), result.spread, result.magnification));
  return result;
}

Eigen::Matrix3Xd
movedPoints(const Eigen::Matrix4d& T_target_source, const Eigen::Matrix3Xf& points)
{
  Eigen::Matrix3Xd moved(3, points.cols());
  Eigen::Index num_finite = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    if (points.col(i).allFinite())
      moved.col(num_finite++) =
          (T_target_source * points.col(i).cast<double>().homogeneous()).head<3>();
  moved.conservativeResize(3, num_finite);
  return moved;
}

Eigen::Matrix3Xd
shownPoints(const Scene& scene, const Layers& layers)
{
  Eigen::Matrix3Xd points = movedPoints(scene.final_matrix, scene.source);
  if (layers.count(Layer::Target) > 0)
    append(movedPoints(Eigen::Matrix4d::Identity(), scene.target), points);
  if (layers.count(Layer::Source) > 0)
    append(movedPoints(scene.guess, scene.source), points);
  if (scene.uncertainty && layers.count(Layer::Position) > 0)
    append(positionEllipsoid(scene).vertices, points);
  if (scene.uncertainty && layers.count(Layer::Rotation) > 0)
    for (const Mesh& cone : rotationCones(scene))
      append(cone.vertices, points);
  return points;
}

std::array<Mesh, 3>
rotationCones(const Scene& scene)
{
  const PoseSpread& spread = scene.uncertainty->spread;
  const Eigen::Matrix3d R = rotationOf(spread.mean);
  const Eigen::Matrix3d covariance = spread.covariance.bottomRightCorner<3, 3>();
  const double length = 0.5 * sizeOf(scene.source);
  std::array<Mesh, 3> cones;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d direction = R.col(static_cast<Eigen::Index>(k));
    cones[k] =
        coneMesh(spread.position(),
                 direction,
                 scene.uncertainty->magnification *
                     tipAxes(covariance, direction, chi_squared_95_percent_3_dof),
                 length);
  }
  return cones;
}

Mesh
positionEllipsoid(const Scene& scene)
{
  const PoseSpread& spread = scene.uncertainty->spread;
  return ellipsoidMesh(spread.position(),
                       scene.uncertainty->magnification *
                           regionAxes(spread.covariance.topLeftCorner<3, 3>(),
                                      chi_squared_95_percent_3_dof));
}

Eigen::Matrix3Xd
pointsAtDraws(const Scene& scene, Eigen::Index max_points)
{
  const std::vector<Eigen::Matrix4d>& draws = scene.uncertainty->shown_draws;
  const Eigen::Index wanted =
      std::max<Eigen::Index>(1, max_points / static_cast<Eigen::Index>(draws.size()));
  Random random(1, 0);
  Eigen::Matrix3Xd all(3, 0);
  for (const Eigen::Matrix4d& draw : draws) {
    const Eigen::Matrix3Xf chosen =
        scene.source(Eigen::all, randomChoice(scene.source.cols(), wanted, random));
    append(movedPoints(draw, chosen), all);
  }
  return all;
}

double
sizeOf(const Eigen::Matrix3Xf& points)
{
  const Eigen::Matrix3Xd finite = movedPoints(Eigen::Matrix4d::Identity(), points);
  if (finite.cols() == 0)
    return 0.0;
  return (finite.rowwise().maxCoeff() - finite.rowwise().minCoeff()).norm();
}

} // namespace bayesian_icp::viewer
