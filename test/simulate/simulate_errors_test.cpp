/** \file
 * \brief The sensor errors of the scan simulator: are the points off the surface by the
 * errors that were asked for? Statistical bounds are two-sided at 1e-6, seeds fixed.
 */
#include "simulate/simulate_helpers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

using namespace bayesian_icp;
using namespace bayesian_icp::simulator;
using Eigen::Vector3d;

namespace {

/** \brief Calls f(point of a, point of b) for each ray that both scans have. */
void
forCommonRays(const Scan& a,
              const Scan& b,
              const std::function<void(const Vector3d&, const Vector3d&)>& f)
{
  std::map<std::uint32_t, Eigen::Index> columns_of_b;
  for (std::size_t i = 0; i < b.ray_indices.size(); ++i)
    columns_of_b[b.ray_indices[i]] = static_cast<Eigen::Index>(i);
  for (std::size_t i = 0; i < a.ray_indices.size(); ++i) {
    const auto found = columns_of_b.find(a.ray_indices[i]);
    if (found != columns_of_b.end())
      f(a.points.col(static_cast<Eigen::Index>(i)), b.points.col(found->second));
  }
}

} // namespace

TEST(SensorNoise, OfTheCameraIsThatOfAKinectTimesTheFactor)
{
  SimulationOptions options = cleanOptions("table");
  options.sensor.camera.width = 480;
  options.sensor.camera.height = 360;
  const Scan clean = scanTarget(options);
  options.sensor.noise = 1.5;
  const Scan noisy = scanTarget(options);
  double sum = 0.0;
  double count = 0.0;
  forCommonRays(clean, noisy, [&](const Vector3d& truth, const Vector3d& point) {
    const double z = truth.z();
    const double sigma = 1.5 * (0.0012 + 0.0019 * (z - 0.4) * (z - 0.4));
    sum += std::pow((point.z() - z) / sigma, 2);
    count += 1.0;
    ASSERT_LT(truth.cross(point).norm(), 1e-12) << "the error is along the ray";
  });
  expectChiSquared(sum, count);
}

TEST(SensorNoise, IsIndependentInTheTwoScans)
{
  // In a closed room every ray returns, so columns of all clouds belong to the same
  // rays.
  SimulationOptions options = cleanOptions("room");
  options.source_view = options.target_view;
  const ScanPair clean = simulate(options);
  options.sensor.noise = 1.0;
  const ScanPair noisy = simulate(options);
  ASSERT_EQ(noisy.source.cols(), clean.source.cols());
  ASSERT_EQ(noisy.target.cols(), clean.target.cols());
  const auto errors = [](const Eigen::Matrix3Xf& points,
                         const Eigen::Matrix3Xf& truth) {
    return (points.colwise().norm() - truth.colwise().norm()).cast<double>().eval();
  };
  const Eigen::RowVectorXd source = errors(noisy.source, clean.source);
  const Eigen::RowVectorXd target = errors(noisy.target, clean.target);
  const double correlation = source.dot(target) / (source.norm() * target.norm());
  EXPECT_GT(source.norm(), 0.0);
  EXPECT_LT(std::abs(correlation),
            bound_in_sigmas / std::sqrt(static_cast<double>(source.size())));
}

TEST(SensorNoise, AcrossTheRayDisplacesThePixel)
{
  SimulationOptions options = cleanOptions("ground");
  options.sensor.kind = SensorKind::DepthCamera;
  options.target_view = {{0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}};
  options.sensor.camera.lateral_noise = 2.0;
  const double focal_length = 80.0 / std::tan(28.5 * degree);
  const Vector3d up(0.0, -std::sqrt(0.5), -std::sqrt(0.5));
  double sum = 0.0;
  double count = 0.0;
  const Scan scan = scanTarget(options);
  for (const Vector3d point : scan.points.colwise()) {
    // On the ground, one metre below, z (y + 1) sqrt(1/2) = 1 with y the slope
    // downwards: the depth tells which row of the image the ray went through.
    const Vector3d ray = point / point.z();
    const double row_slope = std::sqrt(2.0) / point.z() - 1.0;
    const double displacement = (row_slope - ray.y()) * focal_length;
    const double angle = std::acos(-up.dot(ray.normalized()));
    const double sigma = 2.0 * (0.8 + 0.035 * angle / (90.0 * degree - angle));
    sum += std::pow(displacement / sigma, 2);
    count += 1.0;
  }
  expectChiSquared(sum, count);
}

TEST(SensorErrors, OutliersAreAsManyAndAsFarAsStated)
{
  SimulationOptions options = cleanOptions("table");
  const Scan clean = scanTarget(options);
  options.sensor.outliers = 0.1;
  options.sensor.outlier_spread = 0.2;
  double outliers = 0.0;
  double count = 0.0;
  double sum_of_squares = 0.0;
  const auto compare = [&](const Vector3d& truth, const Vector3d& point) {
    const double error = point.z() - truth.z();
    outliers += error != 0.0;
    count += 1.0;
    sum_of_squares += error * error;
    ASSERT_LE(std::abs(error), 0.2);
  };
  forCommonRays(clean, scanTarget(options), compare);
  ASSERT_EQ(count, clean.points.cols());
  EXPECT_NEAR(outliers, 0.1 * count, bound_in_sigmas * std::sqrt(0.09 * count));
  // A uniform error in +-a has the mean square a^2/3, which varies by a^2 sqrt(4/45).
  EXPECT_NEAR(sum_of_squares / outliers,
              0.04 / 3.0,
              bound_in_sigmas * 0.04 * std::sqrt(4.0 / 45.0 / outliers));
}

TEST(SensorErrors, ReadingsGetLostAtGrazingAngles)
{
  SimulationOptions options = cleanOptions("ground");
  options.sensor.lidar.azimuth_step = 0.5;
  const Scan all = scanTarget(options);
  options.sensor.dropout_from = 60.0;
  const Scan kept = scanTarget(options);
  double expected = 0.0;
  double variance = 0.0;
  for (const Vector3d point : all.points.colwise()) {
    const double angle = std::acos(-point.z() / point.norm()) / degree;
    const double lost = std::max(0.0, (angle - 60.0) / 30.0);
    expected += 1.0 - lost;
    variance += lost * (1.0 - lost);
  }
  ASSERT_GT(variance, 100.0);
  EXPECT_NEAR(static_cast<double>(kept.points.cols()),
              expected,
              bound_in_sigmas * std::sqrt(variance));
}

TEST(SensorErrors, QuantisationLeavesMultiples)
{
  SimulationOptions options = cleanOptions("table");
  options.sensor.noise = 1.0;
  options.sensor.quantisation = Quantisation::Step;
  options.sensor.quantisation_step = 0.01;
  const Scan steps = scanTarget(options);
  options.sensor.quantisation = Quantisation::Kinect;
  const Scan disparities = scanTarget(options);
  ASSERT_GT(steps.points.cols(), 1000);
  for (const double depth : steps.points.row(2)) {
    const double multiple = depth / 0.01;
    ASSERT_NEAR(multiple, std::round(multiple), 1e-9);
  }
  for (const double depth : disparities.points.row(2)) {
    const double disparity = 345.0 / depth;
    ASSERT_NEAR(disparity, std::round(disparity), 1e-9);
  }
}
