#include "viewer/geometry/shapes.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace bayesian_icp::viewer {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr int num_rim_points = 96;

template <int size>
Eigen::Matrix<double, size, size>
scaledEigenvectors(const Eigen::Matrix<double, size, size>& covariance, double level)
{
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, size, size>> solver(
      covariance);
  return (solver.eigenvectors() *
          (level * solver.eigenvalues()).cwiseMax(0.0).cwiseSqrt().asDiagonal())
      .rowwise()
      .reverse();
}

} // namespace

Eigen::Matrix3d
regionAxes(const Eigen::Matrix3d& covariance, double level)
{
  return scaledEigenvectors<3>(covariance, level);
}

Eigen::Matrix<double, 3, 2>
tipAxes(const Eigen::Matrix3d& rotation_covariance,
        const Eigen::Vector3d& direction,
        double level)
{
  Eigen::Matrix<double, 3, 2> plane;
  plane.col(0) = direction.unitOrthogonal();
  plane.col(1) = direction.cross(plane.col(0));
  // w x direction = plane (plane^T (w x direction)) = plane tips w.
  Eigen::Matrix<double, 2, 3> tips;
  for (int k = 0; k < 2; ++k)
    tips.row(k) = direction.cross(plane.col(k)).transpose();
  const Eigen::Matrix2d covariance = tips * rotation_covariance * tips.transpose();
  return plane * scaledEigenvectors<2>(covariance, level);
}

Eigen::Matrix3Xd
coneOf(const Eigen::Vector3d& apex,
       const Eigen::Vector3d& direction,
       const Eigen::Matrix<double, 3, 2>& tip_axes,
       double length)
{
  Eigen::Matrix3Xd cone(3, num_rim_points + 1);
  cone.col(0) = apex;
  for (int i = 0; i < num_rim_points; ++i) {
    const double phase = 2.0 * pi * i / num_rim_points;
    const Eigen::Vector3d tip =
        tip_axes * Eigen::Vector2d(std::cos(phase), std::sin(phase));
    const double angle = std::min(tip.norm(), pi);
    cone.col(i + 1) = apex + length * (std::cos(angle) * direction +
                                       std::sin(angle) * tip.stableNormalized());
  }
  return cone;
}

} // namespace bayesian_icp::viewer
