// Priors from messages: the inverse of what the exports do.
#include "examples/kalman.h"
#include "localization/localization_test_support.h"
#include "localization/stated_pose.h"
#include "support/test_support.h"

#include <bayesian_icp/measurement.h>
#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <cmath>
#include <limits>

using namespace bayesian_icp;
using namespace bayesian_icp::test;
using app::priorFrom;
using app::StatedPose;

namespace {

Vector6d
somePose()
{
  return Vector6d(12.0, -7.0, 0.4, 0.3, -0.5, 2.6);
}

StatedPose
stated(const Vector6d& pose, const Matrix6d& covariance)
{
  StatedPose result = statedPose(matrixOf(pose), 1.0, 0);
  result.covariance = covariance;
  return result;
}

/** Errors of x, y, z, roll, pitch, yaw by those of R3xSO3, by central differences. */
Matrix6d
parametersByFixedAxes(const Vector6d& mean)
{
  constexpr double step = 1e-5;
  Matrix6d derivative;
  for (int k = 0; k < 6; ++k) {
    const auto errorOf = [&](double size) {
      return poseError(
          poseFromError(size * Vector6d::Unit(k), mean, CovarianceConvention::R3xSO3),
          mean,
          CovarianceConvention::Parameters);
    };
    derivative.col(k) = (errorOf(step) - errorOf(-step)) / (2.0 * step);
  }
  return derivative;
}

Matrix6d
correlatedCovariance()
{
  Random random(3, 0);
  const Matrix6d factor = 0.1 * randomSquare(random);
  return factor * factor.transpose();
}

std::string
refusalOf(const StatedPose& pose)
{
  try {
    priorFrom(pose);
  }
  catch (const app::Refusal& refusal) {
    return refusal.what();
  }
  return "";
}

} // namespace

TEST(StatedPose, OfAnExportedPriorIsThatPrior)
{
  Random random(5, 0);
  for (int run = 0; run < 20; ++run) {
    Vector6d mean = random.normal6();
    mean[4] = std::atan(mean[4]); // |pitch| < pi/2
    mean = canonicalPose(mean);
    const Vector6d variance = (0.1 * random.normal6()).array().exp() * 0.04;
    PoseWithCovarianceStamped message;
    ExportOptions options;
    options.target_frame = "map";
    options.timestamp_ns = 1700000000250000000;
    fillPoseWithCovarianceStamped(estimateOf(Prior(mean, variance)), options, message);

    const StatedPose pose = app::statedPoseOf(message);
    EXPECT_EQ(pose.frame, "map");
    EXPECT_EQ(pose.stamp_ns, options.timestamp_ns);
    const auto [prior, widening] = priorFrom(pose);
    EXPECT_LT((prior.mean - mean).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((prior.variance.cwiseQuotient(variance) - Vector6d::Ones())
                  .cwiseAbs()
                  .maxCoeff(),
              1e-6);
    EXPECT_NEAR(widening, 1.0, 1e-6);
    EXPECT_EQ(prior.frame, PriorFrame::Origin);
  }
}

TEST(StatedPose, HasRotationsAboutTheFixedAxesOfTheMap)
{
  // A robot that looks along the map's y axis: it rolls about that axis.
  Vector6d pose = Vector6d::Zero();
  pose[5] = 0.5 * M_PI;
  const Vector6d variances(1.0, 2.0, 3.0, 0.01, 0.04, 0.09);
  const PriorOptions prior = priorFrom(stated(pose, variances.asDiagonal())).options;
  const Vector6d expected(1.0, 2.0, 3.0, 0.04, 0.01, 0.09);
  EXPECT_LT((prior.variance - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(StatedPose, WithCorrelationsMakesAPriorThatIsWiderInEveryDirection)
{
  const Matrix6d covariance = correlatedCovariance();
  const auto [prior, widening] = priorFrom(stated(somePose(), covariance));
  const Matrix6d J = parametersByFixedAxes(somePose());
  const Matrix6d in_parameters = J * covariance * J.transpose();
  const Matrix6d excess = Matrix6d(prior.variance.asDiagonal()) - in_parameters;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(excess);
  EXPECT_GT(solver.eigenvalues()[0], -1e-8);
  EXPECT_GT(widening, 1.5);
  EXPECT_LE(widening, 6.0);
  EXPECT_NEAR(prior.variance.cwiseQuotient(in_parameters.diagonal()).maxCoeff(),
              widening,
              1e-6);
}

TEST(StatedPose, OfAPlanarFilterNeedsAFloor)
{
  Matrix6d covariance = Matrix6d::Zero();
  covariance(0, 0) = covariance(1, 1) = 0.25;
  covariance(5, 5) = 0.01;
  const StatedPose pose = stated(Vector6d::Zero(), covariance);
  EXPECT_NE(refusalOf(pose).find("variance of z is 0"), std::string::npos)
      << refusalOf(pose);
  const PriorOptions prior = priorFrom(pose, {0.02, 0.03}).options;
  const Vector6d expected(0.25, 0.25, 4e-4, 9e-4, 9e-4, 0.01);
  EXPECT_LT((prior.variance - expected).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(StatedPose, ThatCannotBeUsedIsRefusedWithTheReason)
{
  const Matrix6d good = 0.01 * Matrix6d::Identity();
  EXPECT_EQ(refusalOf(stated(somePose(), good)), "");

  const auto expectRefusal = [](const StatedPose& pose, const std::string& words) {
    EXPECT_NE(refusalOf(pose).find(words), std::string::npos)
        << words << ": " << refusalOf(pose);
  };
  expectRefusal(stated(somePose(), Matrix6d::Zero()), "variance of x is 0");
  Matrix6d bad = good;
  bad(5, 5) = -1.0;
  expectRefusal(stated(somePose(), bad), "rotation about z is -1");
  bad = good;
  bad(0, 1) = bad(1, 0) = 0.02;
  expectRefusal(stated(somePose(), bad), "not positive semi-definite");
  bad = good;
  bad(0, 1) = 0.005; // the upper triangle alone
  expectRefusal(stated(somePose(), bad), "not symmetric");
  bad = good;
  bad(2, 3) = std::numeric_limits<double>::quiet_NaN();
  expectRefusal(stated(somePose(), bad), "covariance is not finite");
  bad = good;
  bad(0, 0) = std::numeric_limits<double>::max();
  expectRefusal(stated(somePose(), bad), "beyond 1e+100");

  StatedPose pose = stated(somePose(), good);
  pose.orientation.coeffs().setZero();
  expectRefusal(pose, "length 0");
  pose = stated(somePose(), good);
  pose.position[1] = std::numeric_limits<double>::infinity();
  expectRefusal(pose, "pose is not finite");
  Vector6d up = Vector6d::Zero();
  up[4] = 0.5 * M_PI;
  expectRefusal(stated(up, good), "pitch");
}

TEST(KalmanExample, HasAPriorInTheAxesOfTheTarget)
{
  // A quarter turn: the source's x axis is the target's y axis.
  const Vector6d mean(1.0, 2.0, 3.0, 0.0, 0.0, std::acos(0.0)),
      variances(1.0, 4.0, 9.0, 0.01, 0.04, 0.09),
      expected(4.0, 1.0, 9.0, 0.01, 0.04, 0.09);
  const Prior prior = kalman::priorAbout({matrixOf(mean), variances.asDiagonal()});
  EXPECT_TRUE(prior.mean().isApprox(mean, 1e-12)) << prior.mean();
  EXPECT_TRUE(prior.variance().isApprox(25.0 * expected, 1e-9)) << prior.variance();
}

TEST(KalmanExample, FollowsATurnThatTheCloudsHardlySee)
{
  // A can whose axis is 70 mm from the origin; the clouds know its turn to 0.15 rad and
  // the rest to a tenth of a millimetre. Their mean is two deviations off.
  constexpr double turn_deviation = 0.15, deviation = 1e-4;
  const Vector6d turn(
      0.0, -0.07, 0.0, 0.0, 0.0, 1.0); // exp() turns about (0.07 m, 0, 0)
  const Eigen::Matrix4d truth = matrixOf(somePose());
  kalman::State measured, state;
  measured.T = truth * expSE3(2.0 * turn_deviation * turn);
  measured.P = deviation * deviation * Matrix6d::Identity() +
               turn_deviation * turn_deviation * turn * turn.transpose();
  const Vector6d odometry_error(0.015, 0.02, -0.01, 0.01, 0.008, -0.009);
  state.T = truth * expSE3(odometry_error);
  state.P = 0.02 * 0.02 * Matrix6d::Identity();
  const kalman::State fused = update(state, measured);
  const Vector6d error = logSE3(fused.T.inverse() * truth);
  EXPECT_LT(squaredError(error, fused.P), chi_square_99) << error.transpose();
  EXPECT_NEAR(std::sqrt(fused.P(5, 5)), 0.02, 0.001);
}
