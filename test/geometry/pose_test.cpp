// Poses, their derivatives, SO(3) and SE(3), and the four covariance conventions.
#include "support/test_support.h"

#include <bayesian_icp/pose.h>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <unsupported/Eigen/MatrixFunctions>

#include <limits>

namespace bayesian_icp {
namespace {

const double pi = std::acos(-1.0);

Eigen::Matrix4d
hat(const Vector6d& twist)
{
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  m(0, 1) = -twist[5];
  m(0, 2) = twist[4];
  m(1, 0) = twist[5];
  m(1, 2) = -twist[3];
  m(2, 0) = -twist[4];
  m(2, 1) = twist[3];
  m.topRightCorner<3, 1>() = twist.head<3>();
  return m;
}

/** Rotation vectors of the lengths at which series and inverses go wrong. */
std::vector<Eigen::Vector3d>
criticalRotationVectors()
{
  Random random(3, 0);
  std::vector<Eigen::Vector3d> vectors = {Eigen::Vector3d::Zero()};
  for (const double length :
       {1e-12, 1e-8, 1e-5, 0.00999, 0.01001, 0.5, 2.0, pi - 1e-4, pi - 1e-7})
    for (int i = 0; i < 5; ++i)
      vectors.push_back(
          length * Eigen::Vector3d(random.normal(), random.normal(), random.normal())
                       .normalized());
  return vectors;
}

TEST(Pose, RotationIsYawAfterPitchAfterRoll)
{
  Random random(1, 0);
  for (int i = 0; i < 20; ++i) {
    const Vector6d pose = test::randomPose(random);
    const Eigen::Matrix3d expected =
        (Eigen::AngleAxisd(pose[5], Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(pose[4], Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(pose[3], Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    EXPECT_LT((rotationOf(pose) - expected).norm(), 1e-14);
  }
}

TEST(Pose, MatrixAndPoseAreInverse)
{
  Random random(2, 0);
  for (int i = 0; i < 100; ++i) {
    const Vector6d pose = test::randomPose(random);
    EXPECT_LT((poseOf(matrixOf(pose)) - pose).norm(), 1e-12) << pose.transpose();
  }
}

TEST(Pose, NearGimbalLockTheRotationSurvives)
{
  for (const double offset : {0.0, 1e-14, 1e-9, 1e-5})
    for (const double sign : {-1.0, 1.0}) {
      Vector6d pose;
      pose << 0.1, 0.2, 0.3, 0.4, sign * (pi / 2 - offset), -1.2;
      const Vector6d back = poseOf(matrixOf(pose));
      EXPECT_LT((matrixOf(back) - matrixOf(pose)).norm(), 1e-11) << offset;
      if (offset == 0.0) {
        EXPECT_EQ(back[3], 0.0);
      }
    }
}

/** A symmetric stretch leaves the nearest rotation as it is. */
TEST(Pose, IsThatOfTheNearestRotation)
{
  Random random(5, 0);
  for (const double size : {1e-14, 1e-10, 2e-9, 1e-8, 1e-6, 1e-2}) {
    const Vector6d pose = test::randomPose(random, 0.8);
    Eigen::Matrix4d stretched = matrixOf(pose);
    const Eigen::Matrix3d noise =
        size * Eigen::Matrix3d::NullaryExpr([&] { return random.normal(); });
    stretched.topLeftCorner<3, 3>() *=
        Eigen::Matrix3d::Identity() + noise + noise.transpose();
    EXPECT_LT((poseOf(stretched) - pose).norm(), 1e-13) << size;
  }
}

TEST(Pose, NonFiniteMatrixGivesNaN)
{
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m(1, 2) = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(poseOf(m).array().isNaN().all());
}

TEST(Pose, WrappedAnglesLieInTheHalfOpenInterval)
{
  EXPECT_DOUBLE_EQ(wrapAngle(pi), pi);
  EXPECT_DOUBLE_EQ(wrapAngle(-pi), pi);
  EXPECT_DOUBLE_EQ(wrapAngle(3.0 * pi), pi);
  EXPECT_NEAR(wrapAngle(7.0), 7.0 - 2.0 * pi, 1e-15);
  EXPECT_NEAR(wrapAngle(-1e3), -1e3 + 318.0 * pi, 1e-12);
}

TEST(Pose, CanonicalAnglesOfAnyFiniteOnesAreFinite)
{
  for (const double angle : {1e300, 1e308, std::numeric_limits<double>::max()})
    for (const double sign : {-1.0, 1.0})
      EXPECT_TRUE(
          canonicalPose(Vector6d::Constant(sign * angle)).tail<3>().allFinite());
}

TEST(Pose, CanonicalPoseIsTheSameMotionWithSmallPitch)
{
  Random random(5, 0);
  for (int i = 0; i < 100; ++i) {
    Vector6d pose = test::randomPose(random);
    pose.tail<3>() *= 4.0;
    const Vector6d canonical = canonicalPose(pose);
    EXPECT_LE(std::abs(canonical[4]), pi / 2 + 1e-12);
    EXPECT_LE(canonical.tail<3>().cwiseAbs().maxCoeff(), pi);
    EXPECT_LT((matrixOf(canonical) - matrixOf(pose)).norm(), 1e-12);
  }
}

TEST(Pose, RotationDerivativesMatchCentralDifferences)
{
  Random random(6, 0);
  for (int i = 0; i < 20; ++i) {
    const Vector6d pose = test::randomPose(random);
    const auto derivatives = rotationDerivativesOf(pose);
    for (int k = 0; k < 3; ++k) {
      const Vector6d h = 1e-6 * Vector6d::Unit(3 + k);
      const Eigen::Matrix3d numeric =
          (rotationOf(pose + h) - rotationOf(pose - h)) / 2e-6;
      EXPECT_LT((derivatives[static_cast<std::size_t>(k)] - numeric).norm(), 1e-9);
    }
  }
}

TEST(SO3, LogInvertsExp)
{
  for (const auto& w : criticalRotationVectors())
    EXPECT_LT((logSO3(expSO3(w)) - w).norm(), 1e-12 + 1e-8 * (w.norm() > 3.0))
        << w.norm();
}

TEST(SO3, HalfTurnHasALog)
{
  const Eigen::Vector3d w = pi * Eigen::Vector3d(0.6, 0.0, -0.8);
  const Eigen::Vector3d back = logSO3(expSO3(w));
  EXPECT_NEAR(back.norm(), pi, 1e-12);
  EXPECT_LT((expSO3(back) - expSO3(w)).norm(), 1e-12);
}

/** And so is that of SO(3), the rotation of it. */
TEST(SE3, ExpIsTheMatrixExponentialAndLogInvertsIt)
{
  for (const auto& w : criticalRotationVectors()) {
    Vector6d twist;
    twist << 0.3, -1.2, 0.7, w;
    const Eigen::Matrix4d expected = hat(twist).exp();
    EXPECT_LT((expSE3(twist) - expected).norm(), 1e-13) << w.norm();
    EXPECT_LT((logSE3(expSE3(twist)) - twist).norm(), 1e-12 + 1e-7 * (w.norm() > 3.0))
        << w.norm();
  }
}

TEST(Conventions, PoseFromErrorInvertsPoseError)
{
  Random random(7, 0);
  for (const auto convention : covariance_conventions)
    for (int i = 0; i < 20; ++i) {
      const Vector6d mean = test::randomPose(random, 0.9);
      const Vector6d pose = test::randomPose(random, 0.9);
      const Vector6d error = poseError(pose, mean, convention);
      EXPECT_LT(
          (matrixOf(poseFromError(error, mean, convention)) - matrixOf(pose)).norm(),
          1e-9)
          << toString(convention);
    }
  // A pitch that passes 90 degrees.
  const Vector6d mean = (Vector6d() << 1.0, 2.0, 3.0, 3.1, 1.56, -3.1).finished();
  const Vector6d error = (Vector6d() << 0.1, 0.2, 0.3, 0.2, 0.05, -0.1).finished();
  for (const auto convention : covariance_conventions)
    EXPECT_LT(
        (poseError(poseFromError(error, mean, convention), mean, convention) - error)
            .norm(),
        1e-9)
        << toString(convention);
}

TEST(Conventions, AreDefinedByTheSideOfTheirPerturbation)
{
  Random random(9, 0);
  const Vector6d mean = test::randomPose(random, 0.9);
  const Eigen::Matrix4d T = matrixOf(mean);
  Vector6d xi;
  xi << 0.02, -0.03, 0.01, 0.2, -0.1, 0.15;
  EXPECT_LT(
      (poseError(poseOf(expSE3(xi) * T), mean, CovarianceConvention::LeftSE3) - xi)
          .norm(),
      1e-12);
  EXPECT_LT(
      (poseError(poseOf(T * expSE3(xi)), mean, CovarianceConvention::RightSE3) - xi)
          .norm(),
      1e-12);
  Eigen::Matrix4d moved = T;
  moved.topRightCorner<3, 1>() += xi.head<3>();
  moved.topLeftCorner<3, 3>() = expSO3(xi.tail<3>()) * T.topLeftCorner<3, 3>();
  EXPECT_LT((poseError(poseOf(moved), mean, CovarianceConvention::R3xSO3) - xi).norm(),
            1e-12);
}

TEST(Conventions, AngleErrorsAreWrappedAboutTheMean)
{
  Vector6d mean = Vector6d::Zero(), pose = Vector6d::Zero();
  mean[5] = pi - 0.01;
  pose[5] = -pi + 0.01;
  EXPECT_NEAR(poseError(pose, mean, CovarianceConvention::Parameters)[5], 0.02, 1e-12);
}

} // namespace
} // namespace bayesian_icp
