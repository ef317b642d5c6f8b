#include "viewer/scene.h"

#include "io/picture_numbers.h"

#include <bayesian_icp/random.h>

#include <algorithm>

namespace bayesian_icp::viewer {

namespace {

void
append(const Eigen::Matrix3Xd& more, Eigen::Matrix3Xd& points)
{
  points.conservativeResize(3, points.cols() + more.cols());
  points.rightCols(more.cols()) = more;
}

/** Length of the box of \p points from corner to corner [m]. */
double
sizeOf(const Eigen::Matrix3Xd& points)
{
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

} // namespace

double
niceMagnification(double largest_deviation, double size)
{
  constexpr double largest_share = 0.05;
  double best = 1.0;
  for (const double factor : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0})
    if (factor * largest_deviation <= largest_share * size)
      best = factor;
  return best;
}

std::optional<Uncertainty>
uncertaintyOf(const Scene& scene, const ViewOptions& options)
{
  if (scene.draws.rows() < 2)
    return std::nullopt;
  Uncertainty result;
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();
  if (options.reference == Reference::Centroid)
    reference = scene.source.rowwise().mean();
  result.spread = spreadAt(reference, scene.draws);
  result.point_deviations = pointDeviations(scene.source, scene.draws);
  result.magnification =
      options.magnification > 0.0
          ? options.magnification
          : niceMagnification(std::max(result.point_deviations.maxCoeff(),
                                       result.spread.positionDeviations()[0]),
                              sizeOf(scene.source));
  for (const Eigen::Index draw :
       io::evenlySpaced(scene.draws.rows(), options.num_draws))
    result.shown_draws.push_back(magnified(
        scene.draws.row(draw).transpose(), result.spread, result.magnification));
  return result;
}

Eigen::Matrix3Xd
shownPoints(const Scene& scene, const Layers& layers)
{
  Eigen::Matrix3Xd points = Eigen::Affine3d(scene.final_matrix) * scene.source;
  if (layers.count(Layer::Target) > 0)
    append(scene.target, points);
  if (layers.count(Layer::Source) > 0)
    append(Eigen::Affine3d(scene.guess) * scene.source, points);
  if (scene.uncertainty && layers.count(Layer::Position) > 0) {
    const Eigen::Vector3d ones = Eigen::Vector3d::Ones();
    const Eigen::AlignedBox3d box(-ones, ones);
    Eigen::Matrix3Xd corners(3, 8);
    for (int i = 0; i < 8; ++i)
      corners.col(i) = box.corner(Eigen::AlignedBox3d::CornerType(i));
    append(positionEllipsoid(scene) * corners, points);
  }
  if (scene.uncertainty && layers.count(Layer::Rotation) > 0)
    for (const Eigen::Matrix3Xd& cone : rotationCones(scene))
      append(cone, points);
  return points;
}

std::array<Eigen::Matrix3Xd, 3>
rotationCones(const Scene& scene)
{
  const PoseSpread& spread = scene.uncertainty->spread;
  const Eigen::Matrix3d R = rotationOf(spread.mean);
  const Eigen::Matrix3d covariance = spread.covariance.bottomRightCorner<3, 3>();
  const double length = 0.5 * sizeOf(scene.source);
  std::array<Eigen::Matrix3Xd, 3> cones;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d direction = R.col(static_cast<Eigen::Index>(k));
    cones[k] = coneOf(spread.position(),
                      direction,
                      scene.uncertainty->magnification *
                          tipAxes(covariance, direction, chi_squared_95_percent_3_dof),
                      length);
  }
  return cones;
}

Eigen::Affine3d
positionEllipsoid(const Scene& scene)
{
  const PoseSpread& spread = scene.uncertainty->spread;
  Eigen::Affine3d ellipsoid(Eigen::Translation3d(spread.position()));
  ellipsoid.linear() =
      scene.uncertainty->magnification *
      regionAxes(spread.covariance.topLeftCorner<3, 3>(), chi_squared_95_percent_3_dof);
  return ellipsoid;
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
    const Eigen::Matrix3Xd chosen =
        scene.source(Eigen::all, randomChoice(scene.source.cols(), wanted, random));
    append(Eigen::Affine3d(draw) * chosen, all);
  }
  return all;
}

} // namespace bayesian_icp::viewer
