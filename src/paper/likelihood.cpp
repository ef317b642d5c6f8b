#include "paper/likelihood.h"

namespace bayesian_icp {

double
meanEnergy(const Vector6d& pose,
           const Eigen::Matrix3Xd& source_points,
           const Correspondences& correspondences)
{
  const Eigen::Matrix3d R = rotationOf(pose);
  double sum = 0.0;
  for (const auto& pair : correspondences) {
    const auto index = static_cast<Eigen::Index>(pair.source_index);
    const Eigen::Vector3d moved = R * source_points.col(index) + pose.head<3>();
    sum += 0.5 * (moved - pair.target_point).squaredNorm();
  }
  return sum / static_cast<double>(source_points.cols());
}

Vector6d
meanGradient(const Vector6d& pose,
             const Eigen::Matrix3Xd& source_points,
             const Eigen::Matrix3Xd& moved_points,
             const Correspondences& correspondences)
{
  // (p - q)^T dR/dtheta_k s is linear in the outer product (p - q) s^T, so eq. (3)
  // needs only the sum of those.
  Eigen::Vector3d sum_of_residuals = Eigen::Vector3d::Zero();
  Eigen::Matrix3d sum_of_products = Eigen::Matrix3d::Zero();
  for (const auto& pair : correspondences) {
    const auto index = static_cast<Eigen::Index>(pair.source_index);
    const Eigen::Vector3d residual = moved_points.col(index) - pair.target_point;
    sum_of_residuals += residual; // eq. (2)
    sum_of_products.noalias() +=
        residual * source_points.col(index).transpose(); // eq. (3)
  }
  const auto dR = rotationDerivativesOf(pose);
  Vector6d sum;
  sum << sum_of_residuals, dR[0].cwiseProduct(sum_of_products).sum(),
      dR[1].cwiseProduct(sum_of_products).sum(),
      dR[2].cwiseProduct(sum_of_products).sum();
  return sum / static_cast<double>(source_points.cols());
}

} // namespace bayesian_icp
