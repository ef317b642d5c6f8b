#include "graph/sensor_plane.h"

#include <Eigen/Eigenvalues>

namespace bayesian_icp::app {

namespace {

/** A cloud lies in a plane if its thickness is below this fraction of its width: no
 * noise of a 3-D sensor is as small. */
constexpr double max_flatness = 1e-5;

} // namespace

std::optional<Eigen::Vector3d>
planeNormalOf(const Eigen::Matrix3Xd& points)
{
  const Eigen::Matrix3Xd arms = points.colwise() - points.rowwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(
      Eigen::Matrix3d(arms * arms.transpose()));
  const Eigen::Vector3d variances = solver.eigenvalues();
  const double largest = max_flatness * max_flatness * variances[2];
  if (!(variances[0] <= largest && variances[1] > largest))
    return std::nullopt;
  return solver.eigenvectors().col(0);
}

Matrix6d
projectionToPlane(const std::optional<Eigen::Vector3d>& normal)
{
  Matrix6d projection = Matrix6d::Identity();
  if (normal) {
    const Eigen::Matrix3d along = *normal * normal->transpose();
    projection.topLeftCorner<3, 3>() -= along;
    projection.bottomRightCorner<3, 3>() = along;
  }
  return projection;
}

Matrix6d
keptInPlane(const Matrix6d& covariance, const Matrix6d& to_plane)
{
  const double variance = out_of_plane_deviation * out_of_plane_deviation;
  return to_plane * covariance * to_plane +
         variance * (Matrix6d::Identity() - to_plane);
}

} // namespace bayesian_icp::app
