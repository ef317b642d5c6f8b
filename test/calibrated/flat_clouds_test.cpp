// Preset `calibrated` on scans of a 2-D laser scanner, which lie in a plane.
#include "simulator/simulation.h"
#include "support/test_support.h"

#include <bayesian_icp/pipeline.h>
#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <cmath>

namespace bayesian_icp {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/** \param[in] noise of the ranges [m] */
simulator::SimulationOptions
scannerIn(const std::string& scene, std::uint64_t seed, double noise = 0.02)
{
  simulator::SimulationOptions options = simulator::defaultOptions(scene);
  options.sensor.kind = simulator::SensorKind::Lidar;
  options.sensor.lidar.azimuth_step = 0.25;
  options.sensor.lidar.range_noise = noise;
  options.sensor.lidar.rings = 1;
  options.sensor.lidar.min_elevation = options.sensor.lidar.max_elevation = 0.0;
  options.frame = simulator::CloudFrame::Sensor;
  options.seed = seed;
  options.target_view.look_at.z() = options.target_view.eye.z();
  return options;
}

/** Two scans of a robot that has moved by about 15 cm and 0.1 rad. */
struct Scans {
  Scans(const std::string& scene, std::uint64_t seed, double noise = 0.02)
  {
    simulator::SimulationOptions options = scannerIn(scene, seed, noise);
    Random random(seed, 77);
    const Vector6d motion = random.normal6();
    options.source_view = options.target_view;
    options.source_view.eye.head<2>() += 0.15 * motion.head<2>();
    const Vector3d ahead = options.target_view.look_at - options.target_view.eye;
    options.source_view.look_at =
        options.source_view.eye +
        Eigen::AngleAxisd(0.1 * motion[2], Vector3d::UnitZ()) * ahead;
    const simulator::ScanPair pair = simulator::simulate(options);
    source = pair.source.cast<double>();
    target = pair.target.cast<double>();
    truth = poseOf(pair.T_target_source);
  }

  PosteriorEstimate
  estimate(const Options& options = Options(),
           const Vector6d& guess = Vector6d::Zero()) const
  {
    return estimatePosterior(
        PreparedCloud(source), PreparedCloud(target), guess, options);
  }

  Matrix3Xd source, target;
  Vector6d truth;
};

/** Squared error of x, y and yaw, in standard deviations. */
double
squaredErrorInPlane(const Summary& summary, const Vector6d& truth)
{
  const std::array<int, 3> in_plane = {0, 1, 5};
  const Matrix6d& covariance = summary.covariance(CovarianceConvention::Parameters);
  const Vector3d error = (summary.mean - truth)(in_plane);
  return error.dot(Matrix3d(covariance(in_plane, in_plane)).ldlt().solve(error));
}

TEST(FlatClouds, HaveACalibratedMotionInTheirPlane)
{
  constexpr int num_runs = 60;
  double sum = 0.0;
  int num_inside = 0;
  for (int i = 0; i < num_runs; ++i) {
    const Scans scans(i % 2 ? "room" : "office_floor", static_cast<std::uint64_t>(i));
    const Summary summary = scans.estimate().summary;
    ASSERT_EQ(summary.status, Status::Ok) << i << ": " << summary.message;
    const double error = squaredErrorInPlane(summary, scans.truth);
    sum += error / 3.0;
    // 95 % of 3 F(3, 20) times 18/20, the Student's t of the draws.
    num_inside += error < 8.37;
  }
  // Of the mean of chi-square / 3 and Student's t: sqrt(2 / 3 / 60) = 0.105, and a
  // fifth more. Of the count: sqrt(60 * 0.05 * 0.95) = 1.7.
  EXPECT_NEAR(sum / num_runs, 1.0, 3.0 * 0.13);
  EXPECT_GE(num_inside, 57 - 3 * 1.7);
}

TEST(FlatClouds, LeaveTheMotionOutOfThePlaneToThePrior)
{
  const Scans scans("room", 3);
  Options options;
  options.prior.variance << 0.2, 0.2, 0.09, 0.01, 0.04, 0.2;
  Vector6d guess = Vector6d::Zero();
  guess.segment<3>(2) << 0.1, 0.05, -0.08;
  const PosteriorEstimate estimate = scans.estimate(options, guess);
  const Summary& summary = estimate.summary;
  EXPECT_EQ(summary.status, Status::Ok) << summary.message;
  const Matrix6d& covariance = summary.covariance(CovarianceConvention::Parameters);
  for (const int k : {2, 3, 4}) {
    const double variance = options.prior.variance[k];
    // Draws of four chains share their magnitudes: 500 of 2000 are independent.
    EXPECT_NEAR(covariance(k, k), variance, 4.0 * variance * std::sqrt(2.0 / 500.0));
    EXPECT_NEAR(summary.mean[k], guess[k], 0.01 * std::sqrt(variance));
  }
  EXPECT_LT(squaredErrorInPlane(summary, scans.truth), 21.1);
  for (const int k : {0, 1, 5})
    EXPECT_LT(covariance(k, k), 0.01 * 0.01);
  int num_free = 0;
  for (const DataDirection& direction : summary.data.directions)
    num_free += direction.observability == Observability::PriorOnly;
  EXPECT_EQ(num_free, 3);
  EXPECT_NE(summary.message.find("both clouds lie in a plane"), std::string::npos);
  EXPECT_EQ(summary.message.find("held by the prior alone"), std::string::npos);
}

TEST(FlatClouds, NameTheFreeMotionInTheirPlane)
{
  const std::string message = Scans("tunnel", 3).estimate().summary.message;
  EXPECT_NE(message.find("held by the prior alone: translation along"),
            std::string::npos)
      << message;
  EXPECT_EQ(message.find("rotation"), std::string::npos) << message;
}

TEST(FlatClouds, KeepThePriorsMeanIfItIsFarFromThePlane)
{
  const Scans scans("room", 3);
  Options options;
  options.prior.variance << 0.125, 0.125, 1e-6, 1e-6, 1e-6, 1e-10;
  Vector6d guess = Vector6d::Zero();
  guess.segment<3>(2) << 0.2, 0.5, -0.4;
  guess[5] = scans.truth[5];
  const Summary summary = scans.estimate(options, guess).summary;
  // A hundredth of the deviations of z, roll and pitch; those of yaw are 1e-5 rad.
  for (const int k : {2, 3, 4, 5})
    EXPECT_NEAR(summary.mean[k], guess[k], 1e-5);
  EXPECT_LT(squaredErrorInPlane(summary, scans.truth), 21.1);
}

TEST(FlatClouds, HaveOneCovarianceInAllConventionsIfThePriorKeepsThemLevel)
{
  Options options;
  options.prior.variance.segment<3>(2).setConstant(1e-6);
  const Summary summary = Scans("room", 4).estimate(options).summary;
  const auto sdOf = [&](CovarianceConvention convention, int k) {
    return std::sqrt(summary.covariance(convention)(k, k));
  };
  // The mean is 0.2 m and 0.2 rad from the identity, which turns x and y, and adds a
  // lever to them.
  for (const auto convention : covariance_conventions)
    for (const int k : {0, 1, 5})
      EXPECT_NEAR(sdOf(convention, k),
                  sdOf(CovarianceConvention::Parameters, k),
                  0.3 * sdOf(CovarianceConvention::Parameters, k));
}

TEST(FlatClouds, HaveTheSamePosteriorInAnyPlaneWithATightTilt)
{
  const Scans level("room", 5);
  Options options;
  options.prior.variance.segment<3>(2).setConstant(1e-6);
  const PosteriorEstimate expected = level.estimate(options);
  // x, y, z become z, x, y: the plane is that of z and x.
  Scans turned = level;
  Matrix3d R;
  R << 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0;
  turned.source = R * level.source;
  turned.target = R * level.target;
  options.prior.variance.setConstant(0.125);
  for (const int k : {1, 3, 5})
    options.prior.variance[k] = 1e-6;
  const PosteriorEstimate estimate = turned.estimate(options);
  ASSERT_EQ(estimate.summary.status, Status::Ok) << estimate.summary.message;
  const auto sdOf = [](const PosteriorEstimate& of, int k) {
    return std::sqrt(of.summary.covariance(CovarianceConvention::Parameters)(k, k));
  };
  // Draws and the choice of points differ.
  const std::array<int, 3> in_plane = {0, 1, 5}, in_turned = {2, 0, 4};
  for (int i = 0; i < 3; ++i) {
    const double sd = sdOf(expected, in_plane[std::size_t(i)]);
    EXPECT_NEAR(sdOf(estimate, in_turned[std::size_t(i)]), sd, 0.4 * sd);
  }
  EXPECT_NEAR(estimate.summary.mean[4], level.truth[5], 5.0 * sdOf(expected, 5));
}

/** The direction in which points are spread most. */
Vector3d
longestAxis(const Matrix3Xd& points)
{
  const Matrix3Xd offsets = points.colwise() - points.rowwise().mean();
  const Matrix3d scatter = offsets * offsets.transpose();
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(scatter).eigenvectors().col(2);
}

TEST(FlatClouds, KeepTheirFreeMotionInAPlaneObliqueToTheAxes)
{
  // So little noise that the held motions are known far better than the free one.
  const Matrix3d R = rotationOf({0.0, 0.0, 0.0, 0.5, 0.4, 0.7});
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Scans scans("tunnel", seed, seed % 2 ? 0.001 : 0.003);
    const Vector3d level_along = longestAxis(scans.target);
    const Vector3d along = R * level_along;
    const Vector3d across = R * Vector3d::UnitZ().cross(level_along);
    const Vector3d motion = R * scans.truth.head<3>();
    scans.source = (R * scans.source).eval();
    scans.target = (R * scans.target).eval();
    const Summary summary = scans.estimate().summary;
    ASSERT_EQ(summary.status, Status::Ok) << seed << ": " << summary.message;
    const Matrix3d covariance =
        summary.covariance(CovarianceConvention::R3xSO3).topLeftCorner<3, 3>();
    const double sd_along = std::sqrt(along.dot(covariance * along));
    const double sd_across = std::sqrt(across.dot(covariance * across));
    // The prior's, to within what draws of four chains with one magnitude say of it.
    EXPECT_NEAR(sd_along, std::sqrt(0.125), 0.2 * std::sqrt(0.125)) << seed;
    EXPECT_LT(sd_across, 0.05) << seed;
    EXPECT_LT(std::abs(across.dot(summary.mean.head<3>() - motion)), 4.5 * sd_across)
        << seed;
  }
}

TEST(FlatClouds, AreRecognisedByFewBeams)
{
  int num_recognised = 0;
  constexpr int num_scans = 20, beams = 24;
  for (int i = 0; i < num_scans; ++i) {
    Scans scans("office_floor", static_cast<std::uint64_t>(100 + i));
    // A beam every six degrees.
    for (Matrix3Xd* points : {&scans.source, &scans.target})
      *points = (*points)(Eigen::all, Eigen::seq(0, Eigen::last, beams)).eval();
    const Summary summary = scans.estimate().summary;
    const bool is_recognised =
        summary.message.find("both clouds lie in a plane") != std::string::npos;
    num_recognised += is_recognised;
    EXPECT_TRUE(summary.status != Status::Ok ||
                squaredErrorInPlane(summary, scans.truth) < 21.1)
        << i;
  }
  EXPECT_EQ(num_recognised, num_scans);
}

TEST(FlatClouds, HaveTheSameDrawsForAnyNumberOfThreads)
{
  const Scans scans("room", 6);
  Options options;
  options.chains.num_threads = 1;
  const PosteriorEstimate one = scans.estimate(options);
  options.chains.num_threads = 3;
  EXPECT_EQ(one.samples, scans.estimate(options).samples);
}

/** The room as a 3-D LiDAR sees it from the place of the scanner. */
Matrix3Xd
roomInSpace()
{
  simulator::SimulationOptions options = scannerIn("room", 8);
  options.sensor.lidar.rings = 64;
  options.sensor.lidar.min_elevation = -50.0;
  options.sensor.lidar.max_elevation = 40.0;
  options.source_view = options.target_view;
  return simulator::simulate(options).target.cast<double>();
}

TEST(FlatClouds, DoNotFallOnTheFloorOfAMap)
{
  Scans scans("room", 9);
  scans.target = roomInSpace();
  Options options;
  options.prior.variance.segment<2>(3).setConstant(0.02 * 0.02);
  const Summary level = scans.estimate(options).summary;
  EXPECT_EQ(level.status, Status::Ok) << level.message;
  const Summary open = scans.estimate().summary;
  EXPECT_EQ(open.status, Status::Doubtful) << open.message;
  EXPECT_NE(open.message.find("wrong tilt"), std::string::npos) << open.message;
  for (const Summary& summary : {level, open}) {
    EXPECT_LT(std::abs(summary.mean[2]), 0.1);
    EXPECT_LT(squaredErrorInPlane(summary, scans.truth), 21.1);
  }
}

TEST(FlatClouds, AreNoTargetOfAScanInSpace)
{
  Scans scans("room", 10);
  scans.source = roomInSpace();
  const Summary summary = scans.estimate().summary;
  EXPECT_EQ(summary.status, Status::TooFewCorrespondences);
  EXPECT_NE(summary.message.find("the target lies in a plane"), std::string::npos)
      << summary.message;
}

} // namespace
} // namespace bayesian_icp
