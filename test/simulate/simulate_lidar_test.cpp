/** \file
 * \brief The spinning LiDAR of the scan simulator and its scenes: rings, noise, offsets
 * and motion during a scan. Statistical bounds are two-sided at 1e-6, seeds fixed.
 */
#include "simulate/simulate_helpers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

using namespace bayesian_icp;
using namespace bayesian_icp::simulator;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

/** \brief Few rays, no incidence factor, no random phase. */
SensorOptions
coarseLidar(int rings)
{
  SensorOptions options = carLidar(rings);
  options.lidar.azimuth_step = 2.0;
  options.lidar.azimuth_phase = 0.0;
  options.incidence_noise = 0.0;
  return options;
}

/** \brief Seen from its centre, every reading is 10 m. */
Scene
hollowBall()
{
  return {"", "", "", {{"ball", [](const Vector3d& p) { return 10.0 - p.norm(); }}}};
}

Scan
scanOf(const Scene& scene, const SensorOptions& options, std::uint32_t scan_number = 0)
{
  return scanScene(scene, options, Isometry3d::Identity(), 1, scan_number);
}

/** \brief What each reading of the hollow ball is too long [m]. */
Eigen::ArrayXd
errorsOf(const Scan& scan)
{
  return scan.points.colwise().norm().array() - 10.0;
}

/** \brief [azimuth steps] */
double
azimuthOf(const Vector3d& point, const SensorOptions& options)
{
  const double turn = std::atan2(point.y(), point.x()) / (360.0 * degree);
  return (turn - std::floor(turn)) * raysPerRow(options);
}

} // namespace

TEST(CarLidar, HasEvenlySpreadRings)
{
  for (const int rings : {16, 32, 64, 128}) {
    const SensorOptions options = coarseLidar(rings);
    const Scan scan = scanOf(hollowBall(), options);
    ASSERT_EQ(scan.points.cols(), rings * 180);
    const double lowest = rings < 64 ? -15.0 : -25.0;
    for (Eigen::Index i = 0; i < scan.points.cols(); ++i) {
      const Vector3d point = scan.points.col(i);
      const double elevation = std::asin(point.z() / point.norm()) / degree;
      const Eigen::Index ring = i / 180;
      ASSERT_NEAR(
          elevation, lowest + 30.0 / (rings - 1) * static_cast<double>(ring), 1e-9);
    }
  }
  EXPECT_THROW(carLidar(17), std::invalid_argument);
}

TEST(CarLidar, HasTheRaysOfARealOne)
{
  EXPECT_EQ(raysPerRow(carLidar(16)), 1800);
  const Scan scan = scanTarget(defaultOptions("office_floor"));
  EXPECT_NEAR(static_cast<double>(scan.points.cols()), 27000.0, 2000.0);
}

TEST(CarLidar, TurnsEachScanByAnotherPartOfAStep)
{
  SensorOptions options = coarseLidar(16);
  options.lidar.azimuth_phase = 1.0;
  std::vector<double> phases;
  for (const std::uint32_t scan_number : {0U, 1U}) {
    const Scan scan = scanOf(hollowBall(), options, scan_number);
    const double phase = azimuthOf(scan.points.col(0), options);
    EXPECT_GE(phase, 0.0);
    EXPECT_LT(phase, 1.0);
    for (Eigen::Index i = 0; i < scan.points.cols(); ++i)
      ASSERT_NEAR(azimuthOf(scan.points.col(i), options),
                  phase + static_cast<double>(i % 180),
                  1e-9);
    phases.push_back(phase);
  }
  EXPECT_GT(std::abs(phases[0] - phases[1]), 1e-3);
}

TEST(CarLidar, HasIndependentNoiseAboutTheOffsetOfTheRing)
{
  SensorOptions options = coarseLidar(64);
  options.noise = 0.0;
  const Eigen::ArrayXd offsets = errorsOf(scanOf(hollowBall(), options));
  options.noise = 1.5;
  options.lidar.range_noise = 0.03;
  const Eigen::ArrayXd noise =
      (errorsOf(scanOf(hollowBall(), options)) - offsets) / 0.045;
  const auto count = static_cast<double>(noise.size());
  EXPECT_NEAR(noise.sum(), 0.0, bound_in_sigmas * std::sqrt(count));
  expectChiSquared(noise.square().sum(), count);
  const Eigen::Index before = noise.size() - 1;
  EXPECT_NEAR((noise.head(before) * noise.tail(before)).sum(),
              0.0,
              bound_in_sigmas * std::sqrt(count));
}

TEST(CarLidar, HasTheSameOffsetsInEveryScan)
{
  SensorOptions options = coarseLidar(64);
  options.noise = 0.0;
  const Eigen::ArrayXd first = errorsOf(scanOf(hollowBall(), options, 0));
  const Eigen::ArrayXd second = errorsOf(scanOf(hollowBall(), options, 1));
  EXPECT_LT((first - second).abs().maxCoeff(), 1e-9);
  for (Eigen::Index i = 0; i < first.size(); ++i)
    ASSERT_NEAR(first[i], first[i - i % 180], 1e-9) << "within a ring";
}

TEST(CarLidar, HasOffsetsOfTheStatedSpreadAndOthersForAnotherSensor)
{
  SensorOptions options = coarseLidar(64);
  options.noise = 0.0;
  options.lidar.azimuth_step = 180.0;
  double sum = 0.0;
  double sum_of_squares = 0.0;
  constexpr int num_sensors = 100;
  for (int sensor = 0; sensor < num_sensors; ++sensor) {
    options.lidar.sensor_seed = static_cast<std::uint64_t>(sensor);
    const Eigen::ArrayXd offsets = errorsOf(scanOf(hollowBall(), options)) / 0.01;
    sum += 0.5 * offsets.sum();
    sum_of_squares += 0.5 * offsets.square().sum();
  }
  constexpr double count = 64.0 * num_sensors;
  EXPECT_NEAR(sum, 0.0, bound_in_sigmas * std::sqrt(count));
  expectChiSquared(sum_of_squares, count);
}

TEST(CarLidar, MeasuresFromWhereItIsAtTheTimeOfEachRay)
{
  SensorOptions options = coarseLidar(16);
  options.noise = 0.0;
  options.lidar.ring_offset = 0.0;
  options.lidar.azimuth_phase = 1.0;
  // Its walls see every motion.
  const Scene scene = makeScene("room");
  const Isometry3d T_world_sensor =
      sensorPose(SensorKind::Lidar, {{0.0, 0.0, 1.2}, {1.0, 0.1, 1.2}});
  const Vector6d motion(1.0, 0.1, -0.05, 0.02, -0.03, 0.2);
  const Scan scan = scanScene(scene, options, T_world_sensor, 1, 0, motion);
  ASSERT_GT(scan.points.cols(), 1000);
  for (const Vector3d point : scan.points.colwise()) {
    // Of a turn, from the back: 0 where the sensor looks ahead.
    const double time = std::atan2(point.y(), point.x()) / (360.0 * degree);
    const Isometry3d T_now = T_world_sensor * Isometry3d(expSE3(time * motion));
    ASSERT_LT(std::abs(scene.distance(T_now * point)), 1e-5);
  }
}

TEST(DrivenPairs, HaveTheTruthOfTheMiddleOfTheTurns)
{
  SimulationOptions options = defaultOptions("street");
  options.sensor.lidar.azimuth_step = 2.0;
  const ScanPair still = simulate(options);
  options.sweep_motion = 1.0;
  const ScanPair driven = simulate(options);
  EXPECT_FALSE(driven.target.cols() == still.target.cols() &&
               driven.target == still.target);
  EXPECT_TRUE(driven.T_target_source == still.T_target_source);
}

TEST(SceneParts, AreWhereTheirBoundsSay)
{
  for (const std::string name : {"street", "office_floor", "forest"}) {
    const Scene scene = makeScene(name);
    Scene all_looked_at = scene;
    for (ScenePart& part : all_looked_at.parts)
      part.bounds = unbounded();
    SimulationOptions options = cleanOptions(name);
    options.sensor.lidar.azimuth_step = 5.0;
    const auto T_world_sensor = sensorPose(SensorKind::Lidar, options.target_view);
    const Scan scan = scanScene(scene, options.sensor, T_world_sensor, 1, 0);
    const Scan whole = scanScene(all_looked_at, options.sensor, T_world_sensor, 1, 0);
    EXPECT_EQ(scan.ray_indices, whole.ray_indices) << name;
    // Rays end 1e-6 m from a surface; the most slanted ones 100 times as far on.
    EXPECT_TRUE(scan.points.isApprox(whole.points, 1e-5)) << name;
  }
}
