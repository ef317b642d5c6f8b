// Shared by the tests of the calibration: points of known surfaces with known noise,
// and their registration.
#pragma once

#include "calibrated/calibrated_estimate.h"
#include "calibrated/score/surface_score.h"

#include <bayesian_icp/random.h>

#include <cmath>

namespace bayesian_icp::test {

/** A source on a target [m], and a prior about the identity. It stays where it is: the
 * scorer refers to the model. */
struct Problem {
  /** \param[in] deviations of the prior, about the source's centroid [m, rad] */
  Problem(const Eigen::Matrix3Xd& source,
          const Eigen::Matrix3Xd& target,
          const Vector6d& deviations)
  : model(target)
  , scorer(source, model)
  , prior(Vector6d::Zero(), deviations.cwiseAbs2(), scorer.centroid())
  {}
  Problem(const Problem&) = delete;

  CalibratedEstimate
  estimate(const EstimateOptions& options = EstimateOptions(),
           const Eigen::Isometry3d* start = nullptr) const
  {
    return estimateCalibrated(scorer, prior, options, start);
  }

  SurfaceModel model;
  SurfaceScorer scorer;
  Prior prior;
};

/** Of a scorer without hints, with twists about \p centre. */
inline SurfaceScores
scoresAt(const SurfaceScorer& scorer,
         const Eigen::Isometry3d& pose,
         const Eigen::Vector3d& centre,
         double scale)
{
  PatchHints hints;
  SurfaceScores scores;
  scorer.evaluate(pose, centre, scale, hints, scores);
  return scores;
}

/** Points of a surface and its unit normals there, one a column [m]. */
struct Sheet {
  explicit Sheet(Eigen::Index num_points)
  : points(3, num_points)
  , normals(3, num_points)
  {}

  Eigen::Matrix3Xd points;
  Eigen::Matrix3Xd normals;
};

/** Standard normal variates. */
inline Eigen::VectorXd
normals(Random& random, Eigen::Index count)
{
  Eigen::VectorXd values(count);
  for (Eigen::Index i = 0; i < count; ++i)
    values[i] = random.normal();
  return values;
}

/** The points displaced along their normals by independent noise [m]. */
inline Eigen::Matrix3Xd
noisy(const Sheet& sheet, double sigma, Random& random)
{
  return sheet.points +
         sheet.normals * (sigma * normals(random, sheet.points.cols())).asDiagonal();
}

/** Uniform in -half ... half. */
inline double
symmetric(Random& random, double half)
{
  return half * (2.0 * random.uniform() - 1.0);
}

/** The square |x|, |y| <= half of z = 0, uniformly. */
inline Sheet
squarePlane(Random& random, Eigen::Index num_points, double half)
{
  Sheet sheet(num_points);
  for (Eigen::Index i = 0; i < num_points; ++i) {
    const double x = symmetric(random, half), y = symmetric(random, half);
    sheet.points.col(i) << x, y, 0.0;
    sheet.normals.col(i) = Eigen::Vector3d::UnitZ();
  }
  return sheet;
}

/** side x side points of z = 0, row by row, in steps of spacing. */
inline Sheet
gridPlane(Eigen::Index side, double spacing)
{
  Sheet sheet(side * side);
  for (Eigen::Index i = 0; i < side * side; ++i) {
    sheet.points.col(i) << spacing * double(i % side), spacing * double(i / side), 0.0;
    sheet.normals.col(i) = Eigen::Vector3d::UnitZ();
  }
  return sheet;
}

/** About z, uniform by area, |z| <= half_height. */
inline Sheet
cylinder(Random& random, Eigen::Index num_points, double radius, double half_height)
{
  const double pi = std::acos(-1.0);
  Sheet sheet(num_points);
  for (Eigen::Index i = 0; i < num_points; ++i) {
    const double angle = symmetric(random, pi);
    sheet.normals.col(i) << std::cos(angle), std::sin(angle), 0.0;
    sheet.points.col(i) = radius * sheet.normals.col(i);
    sheet.points(2, i) = symmetric(random, half_height);
  }
  return sheet;
}

/** About the origin, uniform by area. */
inline Sheet
sphere(Random& random, Eigen::Index num_points, double radius)
{
  Sheet sheet(num_points);
  for (Eigen::Index i = 0; i < num_points; ++i) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    sheet.normals.col(i) = Eigen::Vector3d(x, y, z).normalized();
    sheet.points.col(i) = radius * sheet.normals.col(i);
  }
  return sheet;
}

/** z = (x^2 - y^2) / (2 radius) over |x|, |y| <= half, uniformly in x and y. */
inline Sheet
saddle(Random& random, Eigen::Index num_points, double radius, double half)
{
  Sheet sheet = squarePlane(random, num_points, half);
  for (Eigen::Index i = 0; i < num_points; ++i) {
    const double x = sheet.points(0, i), y = sheet.points(1, i);
    sheet.points(2, i) = (x * x - y * y) / (2.0 * radius);
    sheet.normals.col(i) = Eigen::Vector3d(-x / radius, y / radius, 1.0).normalized();
  }
  return sheet;
}

/** Faces of the box |x_k| <= half_k, uniform by area, no nearer than margin to an edge.
 */
inline Sheet
box(Random& random,
    Eigen::Index num_points,
    const Eigen::Vector3d& half,
    double margin = 0.0)
{
  const Eigen::Vector3d inner = half.array() - margin;
  const Eigen::Vector3d areas(
      inner.y() * inner.z(), inner.z() * inner.x(), inner.x() * inner.y());
  Sheet sheet(num_points);
  for (Eigen::Index i = 0; i < num_points; ++i) {
    double left = random.uniform() * areas.sum();
    int axis = 0;
    while (axis < 2 && left >= areas[axis])
      left -= areas[axis++];
    const double side = random.uniform() < 0.5 ? -1.0 : 1.0;
    for (int k = 0; k < 3; ++k)
      sheet.points(k, i) = symmetric(random, inner[k]);
    sheet.points(axis, i) = side * half[axis];
    sheet.normals.col(i) = side * Eigen::Vector3d::Unit(axis);
  }
  return sheet;
}

/** Derivatives J^T n of the points' distances along their normals, in twists about the
 * points' centroid. */
inline Matrix6Xd
distanceJacobians(const Sheet& sheet)
{
  const Eigen::Vector3d centre = sheet.points.rowwise().mean();
  Matrix6Xd jacobians(6, sheet.points.cols());
  for (Eigen::Index i = 0; i < sheet.points.cols(); ++i) {
    const Eigen::Vector3d normal = sheet.normals.col(i);
    const Eigen::Vector3d arm = sheet.points.col(i) - centre;
    jacobians.col(i) << normal, arm.cross(normal);
  }
  return jacobians;
}

} // namespace bayesian_icp::test
