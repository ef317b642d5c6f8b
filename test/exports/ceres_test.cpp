// Ceres with our export for ROS as a measurement: its covariance of the pose is ours.
#include "exports/some_estimate.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <ceres/ceres.h>
#include <ceres/covariance.h>
#include <ceres/manifold.h>
#include <ceres/rotation.h>

#include <vector>

using namespace bayesian_icp;
using namespace bayesian_icp::test;

namespace {

/** Shift in the target frame and rotation about its fixed axes, whitened. */
struct Measurement {
  Eigen::Vector3d translation;
  Eigen::Quaterniond rotation;
  Matrix6d whitening;

  template <typename T>
  bool
  operator()(const T* translation_data, const T* rotation_data, T* residual_data) const
  {
    const Eigen::Map<const Eigen::Matrix<T, 3, 1>> t(translation_data);
    const Eigen::Map<const Eigen::Quaternion<T>> q(rotation_data);
    const Eigen::Quaternion<T> turn = q * rotation.cast<T>().conjugate();
    const T ceres_order[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
    Eigen::Matrix<T, 6, 1> error;
    error.template head<3>() = t - translation.cast<T>();
    ceres::QuaternionToAngleAxis(ceres_order, error.data() + 3);
    Eigen::Map<Eigen::Matrix<T, 6, 1>>{residual_data} = whitening.cast<T>() * error;
    return true;
  }
};

TEST(Ceres, SolutionAndCovarianceAreThoseOfTheMeasurement)
{
  const PoseEstimate estimate = estimateOf(drawsAboutMean(0.1));
  const Matrix6d& covariance = estimate.covariance(CovarianceConvention::R3xSO3);
  const Eigen::Isometry3d mean(matrixOf(estimate.mean));
  const Measurement measurement{
      mean.translation(),
      Eigen::Quaterniond(mean.linear()),
      covariance.llt().matrixL().solve(Matrix6d(Matrix6d::Identity()))};
  Eigen::Vector3d translation = mean.translation() + Eigen::Vector3d(0.1, -0.2, 0.05);
  Eigen::Quaterniond rotation =
      Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()) * measurement.rotation;
  ceres::EigenQuaternionManifold quaternions;
  ceres::Problem::Options ownership;
  ownership.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Measurement, 6, 3, 4>(
                               new Measurement(measurement)),
                           nullptr,
                           translation.data(),
                           rotation.coeffs().data());
  problem.SetManifold(rotation.coeffs().data(), &quaternions);
  ceres::Solver::Options options;
  options.function_tolerance = options.gradient_tolerance =
      options.parameter_tolerance = 1e-15;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.FullReport();
  EXPECT_LT((translation - mean.translation()).norm(), 1e-9);
  EXPECT_LT(rotation.angularDistance(measurement.rotation), 1e-7);

  ceres::Covariance of_solution{ceres::Covariance::Options()};
  const std::vector<const double*> blocks = {translation.data(),
                                             rotation.coeffs().data()};
  ASSERT_TRUE(of_solution.Compute(blocks, &problem));
  Eigen::Matrix<double, 6, 6, Eigen::RowMajor> found;
  ASSERT_TRUE(of_solution.GetCovarianceMatrixInTangentSpace(blocks, found.data()));
  // Ceres's steps of a quaternion are half angles.
  const Vector6d angles(1.0, 1.0, 1.0, 2.0, 2.0, 2.0);
  EXPECT_LT(
      relativeDifference(angles.asDiagonal() * Matrix6d(found) * angles.asDiagonal(),
                         covariance),
      1e-6);
}

} // namespace
