// The filter of a track against many tracks whose truth is drawn from its model.
#include "graph/graph_support.h"
#include "track/motion_filter.h"

#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <cmath>
#include <tuple>

using namespace bayesian_icp;
using namespace bayesian_icp::test;
using app::GaussianPose;
using app::MotionFilter;
using app::MotionModel;

namespace {

constexpr int num_runs = 2000, num_steps = 12;
constexpr double seconds = 0.1;

/** Small enough for the first order, and different in all directions. */
MotionModel
model()
{
  MotionModel model;
  model.velocity << 5.0, 0.5, -0.2, 0.1, -0.2, 0.8;
  const Vector6d sd(0.3, 0.1, 0.1, 0.02, 0.02, 0.05);
  model.velocity_covariance = sd.cwiseAbs2().asDiagonal();
  model.acceleration = 0.5;
  model.angular_acceleration = 0.1;
  return model;
}

/** Correlated, of about 5 mm and 1 mrad; the motion along the sensor's x axis is not
 * seen. */
Matrix6d
registrationCovariance()
{
  Matrix6d root = Matrix6d::Identity();
  root.diagonal() << 0.004, 0.006, 0.005, 0.001, 0.0015, 0.001;
  root(1, 5) = 0.003;
  root(2, 4) = -0.002;
  Matrix6d covariance = root * root.transpose();
  covariance(0, 0) = 100.0;
  return covariance;
}

Vector6d
drawnFrom(const Matrix6d& covariance, Random& random)
{
  return covariance.llt().matrixL() * random.normal6();
}

/** What a run comes to. */
struct RunOfTrack {
  double squared_error = 0.0; // of the last pose
  double innovation = 0.0;    // sum over the updates
  int num_updates = 0;
};

/** Truth from the model, registrations from their covariance, of which they have
 * \p shared in common: to the scan before, or to every third; scans 4, 5 and 11 cannot
 * be registered, and scan 8 comes late. */
RunOfTrack
runOf(std::uint64_t seed, int scans_on_target, const app::SharedNoise& shared)
{
  Random random(seed, 0);
  const MotionModel given = model();
  const Matrix6d covariance = registrationCovariance();
  MotionFilter filter(given);
  Vector6d velocity = given.velocity + drawnFrom(given.velocity_covariance, random);
  Eigen::Matrix4d truth = Eigen::Matrix4d::Identity(), target = truth;
  const Matrix6d root =
      Eigen::SelfAdjointEigenSolver<Matrix6d>(covariance).operatorSqrt();
  const Matrix6d common = randomSquare(random);
  Vector6d noise_of_target = random.normal6();
  RunOfTrack run;
  int num_on_target = 0;
  double last_interval = 0.0;
  for (int scan = 1; scan <= num_steps; ++scan) {
    Vector6d acceleration = scan > 1 ? random.normal6() : Vector6d(Vector6d::Zero());
    acceleration.head<3>() *= given.acceleration;
    acceleration.tail<3>() *= given.angular_acceleration;
    const double interval = scan == 8 ? 4.0 * seconds : seconds;
    velocity += 0.5 * (last_interval + interval) * acceleration;
    last_interval = interval;
    truth = truth * expSE3(interval * velocity);
    filter.predict(interval);
    if (scan == 4 || scan == 5 || scan == 11)
      continue;
    // Along x the registration says what the prediction says, as withoutPrior() does.
    const Eigen::Matrix4d in_target = target.inverse() * truth;
    const Vector6d noise = random.normal6();
    Vector6d error =
        -root *
        (std::sqrt(shared.scan) * (noise - turnedBack(in_target, noise_of_target)) +
         std::sqrt(shared.common) * common * alongMotion(in_target) +
         std::sqrt(shared.own()) * random.normal6());
    error[0] = logSE3(in_target.inverse() * matrixOf(filter.poseInTarget().mean))[0];
    run.innovation +=
        filter.update({poseOf(in_target * expSE3(error)), covariance}, shared);
    ++run.num_updates;
    if (++num_on_target == scans_on_target) {
      filter.makeScanTheTarget();
      target = truth;
      noise_of_target = noise;
      num_on_target = 0;
    }
  }
  run.squared_error = squaredErrorOf(filter.pose(), truth);
  return run;
}

/** Scans on a target, and the parts of the noise of a scan and of all registrations. */
class MotionFilterOnTracks
: public ::testing::TestWithParam<std::tuple<int, double, double>> {};

} // namespace

TEST_P(MotionFilterOnTracks, KnowsHowFarItIsOff)
{
  const auto [scans_on_target, of_scan, common] = GetParam();
  Eigen::ArrayXd squared_errors(num_runs), innovations(num_runs);
  for (int k = 0; k < num_runs; ++k) {
    const RunOfTrack run =
        runOf(static_cast<std::uint64_t>(k + 1), scans_on_target, {of_scan, common});
    squared_errors[k] = run.squared_error;
    innovations[k] = run.innovation / run.num_updates;
  }
  // Means of chi-square with 6 degrees of freedom, and with the 5 that are seen.
  EXPECT_NEAR(squared_errors.mean(), 6.0, 4.0 * std::sqrt(12.0 / num_runs));
  // Innovations of one run share the common noise.
  const double variance = (innovations - innovations.mean()).square().mean();
  EXPECT_NEAR(innovations.mean(), 5.0, 4.0 * std::sqrt(variance / num_runs));
}

INSTANTIATE_TEST_SUITE_P(ScansOnATarget,
                         MotionFilterOnTracks,
                         ::testing::Combine(::testing::Values(1, 3),
                                            ::testing::Values(0.0, 0.25, 0.4),
                                            ::testing::Values(0.0, 0.1)));

TEST(MotionFilter, CarriesTheVelocitysErrorAsTheMotionDoes)
{
  constexpr double step = 1e-6;
  MotionModel turning = model();
  turning.velocity << 3.0, -2.0, 1.0, 4.0, -6.0, 7.0; // 1 rad in 0.1 s
  turning.velocity_covariance = registrationCovariance();
  for (const double interval : {seconds, 80.0}) { // the longer one turns 128 times
    const auto motion = [&](const Vector6d& velocity) {
      return expSE3(interval * velocity);
    };
    Matrix6d J;
    for (int k = 0; k < 6; ++k) {
      const Vector6d h = step * Vector6d::Unit(k);
      J.col(k) = logSE3(motion(turning.velocity - h).inverse() *
                        motion(turning.velocity + h)) /
                 (2.0 * step);
    }
    const Matrix6d expected = J * turning.velocity_covariance * J.transpose();
    MotionFilter filter(turning), doubtful(turning);
    filter.predict(interval);
    EXPECT_TRUE(filter.pose().covariance.isApprox(expected, 1e-6)) << interval;
    doubtful.doubtVelocity();
    doubtful.predict(interval);
    EXPECT_TRUE(doubtful.pose().covariance.isApprox(2.0 * expected, 1e-6)) << interval;
  }
}

TEST(MotionFilter, TakesARegistrationsWordAfterALongInterval)
{
  // Of the longest that a track may have.
  MotionModel resting = model();
  resting.velocity.setZero();
  MotionFilter filter(resting);
  Matrix6d covariance = registrationCovariance();
  covariance(0, 0) = 1e-5;
  covariance *= 1e-2;
  const Vector6d rest = Vector6d::Zero();
  for (const double interval : {0.1, 1e5, 0.1, 0.1}) {
    filter.predict(interval);
    filter.update({rest, covariance}, app::independent_noise);
    const Matrix6d stated = filter.poseInTarget().covariance;
    // Without what the motion says, which is little, it is that of the registration.
    const Matrix6d root = covariance.llt().matrixL();
    const Matrix6d half = root.triangularView<Eigen::Lower>().solve(stated);
    const Matrix6d ratio =
        root.triangularView<Eigen::Lower>().solve(Matrix6d(half.transpose()));
    EXPECT_TRUE(ratio.isIdentity(0.1)) << interval << '\n' << ratio;
    filter.makeScanTheTarget();
  }
}

TEST(MotionFilter, GivesBackTheRegistrationWhereNothingElseIsKnown)
{
  MotionModel wide = model();
  wide.velocity_covariance = 1e8 * Matrix6d::Identity();
  MotionFilter filter(wide);
  filter.predict(seconds);
  Matrix6d covariance = registrationCovariance();
  covariance(0, 0) = 1e-4;
  const Vector6d motion(0.4, -0.1, 0.2, 0.02, 0.05, -0.1);
  filter.update({motion, covariance}, app::independent_noise);
  EXPECT_LT((filter.pose().mean - motion).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT((filter.pose().covariance - covariance).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(MotionFilter, FollowsATurnThatTheCloudsHardlySee)
{
  // As KalmanExample.FollowsATurnThatTheCloudsHardlySee: an axis 70 mm from the origin.
  constexpr double turn_deviation = 0.15, deviation = 1e-4;
  const Vector6d turn(0.0, -0.07, 0.0, 0.0, 0.0, 1.0);
  MotionModel still;
  still.velocity_covariance = 0.02 * 0.02 * Matrix6d::Identity();
  still.velocity << 0.015, 0.02, -0.01, 0.01, 0.008, -0.009;
  MotionFilter filter(still);
  filter.predict(1.0);
  const Matrix6d covariance = deviation * deviation * Matrix6d::Identity() +
                              turn_deviation * turn_deviation * turn * turn.transpose();
  const double squared_innovation =
      filter.update({poseOf(expSE3(2.0 * turn_deviation * turn)), covariance});
  EXPECT_LT(squared_innovation, chi_square_99);
  EXPECT_LT(squaredErrorOf(filter.pose(), Eigen::Matrix4d::Identity()), chi_square_99);
  EXPECT_NEAR(std::sqrt(filter.pose().covariance(5, 5)), 0.02, 0.001);
}

TEST(MotionFilter, StaysInThePlaneOfAScannerThatDoesNotSeeOtherMotions)
{
  // The sensor is tilted, so that its plane is not that of x and y.
  const Eigen::Matrix3d tilt =
      Eigen::AngleAxisd(0.6, Eigen::Vector3d(0.6, 0.8, 0.0)).toRotationMatrix();
  Matrix6d turned = Matrix6d::Zero();
  turned.topLeftCorner<3, 3>() = turned.bottomRightCorner<3, 3>() = tilt;
  MotionModel planar = model();
  planar.plane_normal = tilt.col(2);
  const Vector6d in_plane(1.0, 1.0, 0.0, 0.0, 0.0, 1.0);
  const Vector6d first_deviation(0.3, 0.1, 0.0, 0.0, 0.0, 0.05);
  planar.velocity = turned * Vector6d(5.0, 0.5, -0.2, 0.1, -0.2, 0.8);
  planar.velocity_covariance =
      turned *
      (first_deviation.cwiseAbs2() + Vector6d(Vector6d::Ones() - in_plane))
          .asDiagonal() *
      turned.transpose();
  // As withoutPrior() has it: ten deviations of the prediction for what is not seen.
  const Vector6d seen(0.004, 0.006, 0.01, 0.01, 0.01, 0.001);
  const Matrix6d covariance =
      turned * Matrix6d(seen.cwiseAbs2().asDiagonal()) * turned.transpose();
  constexpr int num_planar_runs = 500, num_scans = 40;
  Eigen::ArrayXd squared_errors(num_planar_runs);
  for (int k = 0; k < num_planar_runs; ++k) {
    Random random(static_cast<std::uint64_t>(k + 1), 1);
    MotionFilter filter(planar);
    Vector6d velocity = Vector6d(5.0, 0.5, 0.0, 0.0, 0.0, 0.8) +
                        first_deviation.cwiseProduct(random.normal6());
    Eigen::Matrix4d truth = Eigen::Matrix4d::Identity();
    for (int scan = 1; scan <= num_scans; ++scan) {
      Vector6d change = in_plane.cwiseProduct(random.normal6());
      change.head<3>() *= planar.acceleration * seconds;
      change.tail<3>() *= planar.angular_acceleration * seconds;
      if (scan > 1)
        velocity += change;
      const Eigen::Matrix4d motion = expSE3(seconds * (turned * velocity));
      truth = truth * motion;
      filter.predict(seconds);
      const Vector6d error =
          turned * in_plane.cwiseProduct(seen).cwiseProduct(random.normal6());
      filter.update({poseOf(motion * expSE3(error)), covariance},
                    app::independent_noise);
      filter.makeScanTheTarget();
    }
    const GaussianPose pose = filter.pose();
    const Vector6d error =
        turned.transpose() * logSE3(matrixOf(pose.mean).inverse() * truth);
    const Matrix6d stated = turned.transpose() * pose.covariance * turned;
    for (const int out : {2, 3, 4}) {
      EXPECT_NEAR(error[out], 0.0, 1e-9);
      EXPECT_NEAR(std::sqrt(stated(out, out)), app::out_of_plane_deviation, 1e-9);
    }
    squared_errors[k] = error.dot(stated.llt().solve(error));
  }
  EXPECT_NEAR(squared_errors.mean(), 3.0, 4.0 * std::sqrt(6.0 / num_planar_runs));
}
