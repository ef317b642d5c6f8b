/** \file
 * \brief Noise of the scan simulator that neighbouring readings share, or that depends
 * on the angle of incidence. Statistical bounds are two-sided at 1e-6, seeds fixed.
 */
#include "simulate/simulate_helpers.h"
#include "simulator/noise_field.h"

#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

using namespace bayesian_icp;
using namespace bayesian_icp::simulator;
using Eigen::Vector3d;

namespace {

constexpr double shared_part = 0.7;
constexpr double smoothing = 2.5;

/** \brief Covariance of the noise of two rays, in closed form. */
double
expectedCovariance(int rows_apart, int columns_apart)
{
  const double square = rows_apart * rows_apart + columns_apart * columns_apart;
  const double shared = shared_part * std::exp(-square / (4.0 * smoothing * smoothing));
  return square == 0.0 ? 1.0 : shared;
}

/** \brief Expect of numbers with mean zero that the mean of the products over a
 * distance is what the closed form says. */
void
expectCovariance(const Eigen::ArrayXXd& values, int rows_apart, int columns_apart)
{
  const Eigen::Index rows = values.rows() - rows_apart;
  const Eigen::Index columns = values.cols() - columns_apart;
  const double covariance =
      (values.topLeftCorner(rows, columns) * values.bottomRightCorner(rows, columns))
          .mean();
  // For Gaussians the variance of the mean of n products is at most 2/n times the sum
  // of all squared correlations; the shared part's is an integral of a Gaussian.
  const double pi = 180.0 * degree;
  const double sum_of_squares =
      1.0 + shared_part * shared_part * (2.0 * pi * smoothing * smoothing - 1.0);
  const auto count = static_cast<double>(rows * columns);
  EXPECT_NEAR(covariance,
              expectedCovariance(rows_apart, columns_apart),
              bound_in_sigmas * std::sqrt(2.0 * sum_of_squares / count))
      << rows_apart << " rows, " << columns_apart << " columns apart";
}

SensorOptions
correlatedCamera(int width, int height)
{
  SensorOptions options;
  options.camera.width = width;
  options.camera.height = height;
  options.noise_correlation = shared_part;
  options.noise_correlation_pixels = smoothing;
  return options;
}

} // namespace

TEST(NoiseField, HasTheVarianceAndTheCorrelationOfTheClosedForm)
{
  const NoiseField field(correlatedCamera(1000, 700), 5, 0);
  Random random(5, 0);
  Eigen::ArrayXXd noise(700, 1000);
  for (int row = 0; row < noise.rows(); ++row)
    for (int column = 0; column < noise.cols(); ++column)
      noise(row, column) = field.mixed(random.normal(), row, column);
  for (const auto& apart :
       {std::pair(0, 0), {0, 1}, {1, 0}, {0, 4}, {4, 0}, {3, 4}, {0, 25}, {25, 0}})
    expectCovariance(noise, apart.first, apart.second);
}

TEST(NoiseField, OfALidarIsACircle)
{
  SensorOptions options = correlatedCamera(1, 1);
  options.kind = SensorKind::Lidar;
  options.lidar.rings = 4000;
  options.lidar.azimuth_step = 3.6;
  options.noise_correlation = 1.0;
  const NoiseField field(options, 5, 0);
  const int last = raysPerRow(options) - 1;
  double covariance = 0.0;
  for (int row = 0; row < options.lidar.rings; ++row)
    covariance += field.mixed(0.0, row, last) * field.mixed(0.0, row, 0);
  // As in expectCovariance(), with the squared correlations of one column.
  const double sum_of_squares = std::sqrt(360.0 * degree) * smoothing;
  EXPECT_NEAR(covariance / options.lidar.rings,
              expectedCovariance(0, 1) / shared_part,
              bound_in_sigmas * std::sqrt(2.0 * sum_of_squares / options.lidar.rings));
}

TEST(NoiseField, DiffersBetweenScansAndSeeds)
{
  const SensorOptions options = correlatedCamera(20, 10);
  const double value = NoiseField(options, 1, 0).mixed(0.0, 3, 4);
  EXPECT_EQ(value, NoiseField(options, 1, 0).mixed(0.0, 3, 4));
  EXPECT_NE(value, NoiseField(options, 1, 1).mixed(0.0, 3, 4));
  EXPECT_NE(value, NoiseField(options, 2, 0).mixed(0.0, 3, 4));
}

TEST(NoiseField, LeavesTheNoiseAloneWhenSwitchedOff)
{
  SensorOptions options = correlatedCamera(20, 10);
  options.noise_correlation = 0.0;
  EXPECT_EQ(NoiseField(options, 1, 0).mixed(0.3, 3, 4), 0.3);
}

TEST(SensorNoise, IsSharedByNeighboursWhenAskedFor)
{
  SimulationOptions options = cleanOptions("table_top");
  options.sensor.camera.width = 320;
  options.sensor.camera.height = 240;
  const Scan clean = scanTarget(options);
  options.sensor.noise = 1.0;
  options.sensor.noise_correlation = shared_part;
  options.sensor.noise_correlation_pixels = smoothing;
  const Scan noisy = scanTarget(options);
  ASSERT_EQ(clean.points.cols(), 320 * 240);
  ASSERT_EQ(noisy.points.cols(), 320 * 240);
  Eigen::ArrayXXd errors(240, 320);
  for (Eigen::Index i = 0; i < clean.points.cols(); ++i) {
    const double depth = clean.points(2, i);
    errors(i / 320, i % 320) =
        (noisy.points(2, i) - depth) / readingSigma(options.sensor, depth);
  }
  expectCovariance(errors, 0, 0);
  expectCovariance(errors, 0, 1);
  expectCovariance(errors, 2, 0);
}

TEST(SensorNoise, GrowsWithTheAngleOfIncidenceWhenAskedFor)
{
  SimulationOptions options = cleanOptions("ground");
  options.sensor.lidar.azimuth_step = 1.0;
  const Scan clean = scanTarget(options);
  options.sensor.noise = 1.0;
  options.sensor.incidence_noise = 1.5;
  // So far beyond the farthest point that no noisy reading is out of range.
  options.sensor.max_range = 1e3;
  const Scan noisy = scanTarget(options);
  ASSERT_GE(noisy.points.cols(), clean.points.cols());
  double sum = 0.0;
  int num_capped = 0;
  for (Eigen::Index i = 0; i < clean.points.cols(); ++i) {
    const auto ray = static_cast<std::size_t>(i);
    ASSERT_EQ(noisy.ray_indices[ray], clean.ray_indices[ray]);
    const double range = clean.points.col(i).norm();
    const double factor = std::pow(-clean.points(2, i) / range, -1.5);
    num_capped += factor > 10.0;
    const double sigma = 0.02 * std::min(factor, 10.0);
    sum += std::pow((noisy.points.col(i).norm() - range) / sigma, 2);
  }
  const auto count = static_cast<double>(clean.points.cols());
  expectChiSquared(sum, count);
  EXPECT_GT(num_capped, 300) << "no ray grazes the ground";
  EXPECT_GT(count - num_capped, 3000);
}
