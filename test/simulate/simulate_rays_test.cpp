/** \file
 * \brief The rays of the scan simulator's sensors: do they go where they should, and
 * are bad options refused?
 */
#include "simulate/simulate_helpers.h"
#include "simulator/option_fields.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

using namespace bayesian_icp::simulator;
using Eigen::Vector3d;

TEST(SensorPose, LooksAlongTheView)
{
  const Vector3d eye(1.0, 2.0, 3.0);
  for (const Vector3d& look_at : {Vector3d(-1.0, 0.5, 1.0), Vector3d(1.0, 2.0, 0.0)}) {
    const Vector3d forward = (look_at - eye).normalized();
    const auto camera = sensorPose(SensorKind::DepthCamera, {eye, look_at});
    const auto lidar = sensorPose(SensorKind::Lidar, {eye, look_at});
    EXPECT_TRUE(camera.linear().col(2).isApprox(forward, 1e-14));
    EXPECT_TRUE(lidar.linear().col(0).isApprox(forward, 1e-14));
    EXPECT_LE(camera.linear()(2, 1), 0.0) << "y of the camera points down";
    EXPECT_GE(lidar.linear()(2, 2), 0.0) << "z of the LiDAR points up";
    EXPECT_NEAR(camera.linear().determinant(), 1.0, 1e-14);
    EXPECT_NEAR(lidar.linear().determinant(), 1.0, 1e-14);
  }
}

TEST(SensorRays, OfTheCameraGoThroughThePixelsUpToTheJitter)
{
  SimulationOptions options = cleanOptions("table");
  options.sensor.noise = 1.0;
  const double focal_length = 80.0 / std::tan(28.5 * degree);
  for (const double jitter : {0.0, 0.6}) {
    options.sensor.jitter = jitter;
    const Scan scan = scanTarget(options);
    Vector3d most = Vector3d::Zero();
    for (Eigen::Index i = 0; i < scan.points.cols(); ++i) {
      const std::uint32_t ray = scan.ray_indices[static_cast<std::size_t>(i)];
      const std::uint32_t column = ray % 160, row = ray / 160;
      const Vector3d centre(column + 0.5 - 80.0, row + 0.5 - 60.0, focal_length);
      const Vector3d pixel = scan.points.col(i) / scan.points(2, i) * focal_length;
      most = most.cwiseMax((pixel - centre).cwiseAbs());
    }
    EXPECT_NEAR(most.x(), 0.5 * jitter, 0.001 + 1e-9);
    EXPECT_NEAR(most.y(), 0.5 * jitter, 0.001 + 1e-9);
    EXPECT_LE(most.maxCoeff(), 0.5 * jitter + 1e-9);
  }
}

TEST(SensorOptions, OutsideTheirRangeAreRefusedByName)
{
  const std::vector<std::pair<std::string, double>> bad = {
      {"width", 0},
      {"height", -3},
      {"fov", 180},
      {"lateral-noise", -1},
      {"rings", 0},
      {"max-elevation", -20},
      {"azimuth-step", 0},
      {"range-noise", NAN},
      {"ring-offset", -0.01},
      {"azimuth-phase", 1.5},
      {"noise", INFINITY},
      {"noise-correlation", 1.1},
      {"jitter", 2},
      {"noise-correlation-pixels", 0},
      {"outliers", 1.5},
      {"incidence-noise", -1},
      {"min-range", 0},
      {"dropout-from", 91},
      {"max-range", SensorOptions().min_range}};
  for (const auto& entry : bad) {
    SensorOptions options;
    visitSensor(options, [&entry](const OptionField& field, auto& value) {
      using Value = std::decay_t<decltype(value)>;
      if constexpr (std::is_arithmetic_v<Value>)
        if (field.name == entry.first)
          value = static_cast<Value>(entry.second);
    });
    try {
      validate(options);
      ADD_FAILURE() << entry.first << " was accepted";
    }
    catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()).rfind(entry.first + " is ", 0), 0U)
          << error.what();
    }
  }
}
