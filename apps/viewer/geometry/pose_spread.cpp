#include "viewer/geometry/pose_spread.h"

#include <bayesian_icp/summary.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace bayesian_icp::viewer {

namespace {

using Matrix34d = Eigen::Matrix<double, 3, 4>;

Matrix34d
matrixOfRow(const PoseMatrix& poses, Eigen::Index row)
{
  return matrixOf(poses.row(row).transpose()).topRows<3>();
}

/** T_target_source of a pose whose position is that of the reference. */
Eigen::Matrix4d
matrixFrom(const Vector6d& pose_at_reference, const Eigen::Vector3d& reference)
{
  Eigen::Matrix4d matrix = matrixOf(pose_at_reference);
  matrix.topRightCorner<3, 1>() -= matrix.topLeftCorner<3, 3>() * reference;
  return matrix;
}

/** The pose, its position being that of \p reference (source frame) in the target
 * frame.
 */
Vector6d
poseAt(const Eigen::Vector3d& reference, Vector6d pose)
{
  pose.head<3>() += rotationOf(pose) * reference;
  return pose;
}

PoseMatrix
posesAt(const Eigen::Vector3d& reference, const PoseMatrix& draws)
{
  PoseMatrix poses(draws.rows(), 6);
  for (Eigen::Index i = 0; i < draws.rows(); ++i)
    poses.row(i) = poseAt(reference, draws.row(i).transpose()).transpose();
  return poses;
}

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

Eigen::Vector3d
PoseSpread::positionDeviations() const
{
  return regionAxes(covariance.topLeftCorner<3, 3>(), 1.0).colwise().norm();
}

Eigen::Vector3d
PoseSpread::rotationDeviations() const
{
  return regionAxes(covariance.bottomRightCorner<3, 3>(), 1.0).colwise().norm();
}

Eigen::Matrix4d
PoseSpread::meanMatrix() const
{
  return matrixFrom(mean, reference);
}

PoseSpread
spreadAt(const Eigen::Vector3d& reference, const PoseMatrix& draws)
{
  const PoseMatrix poses = posesAt(reference, draws);
  PoseSpread spread;
  spread.reference = reference;
  spread.mean = meanPose(poses);
  spread.covariance = covarianceAbout(spread.mean, poses, CovarianceConvention::R3xSO3);
  return spread;
}

Eigen::Matrix4d
magnified(const Vector6d& draw, const PoseSpread& spread, double factor)
{
  constexpr CovarianceConvention convention = CovarianceConvention::R3xSO3;
  const Vector6d error =
      poseError(poseAt(spread.reference, draw), spread.mean, convention);
  return matrixFrom(poseFromError(factor * error, spread.mean, convention),
                    spread.reference);
}

Eigen::VectorXd
pointDeviations(const Eigen::Matrix3Xd& points, const PoseMatrix& draws)
{
  // A draw moves q = (s - centroid, 1) to A q. The summed variances are the mean of
  // |(A - mean A) q|^2, a quadratic form of q whose matrix is the same for all points.
  const Eigen::Vector3d centroid = points.rowwise().mean();
  const PoseMatrix poses = posesAt(centroid, draws);
  Matrix34d mean = Matrix34d::Zero();
  for (Eigen::Index i = 0; i < poses.rows(); ++i)
    mean += matrixOfRow(poses, i) / static_cast<double>(poses.rows());
  Eigen::Matrix4d form = Eigen::Matrix4d::Zero();
  for (Eigen::Index i = 0; i < poses.rows(); ++i) {
    const Matrix34d difference = matrixOfRow(poses, i) - mean;
    form += difference.transpose() * difference / static_cast<double>(poses.rows() - 1);
  }
  Eigen::VectorXd deviations(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector4d q = (points.col(i) - centroid).homogeneous();
    deviations[i] = std::sqrt(std::max(0.0, q.dot(form * q)));
  }
  return deviations;
}

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
