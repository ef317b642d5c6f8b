/** \file
 * \brief What the tests of the scan simulator share.
 */
#pragma once

#include "simulator/simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>

/** \brief One degree [rad]. */
constexpr double degree = 3.14159265358979323846 / 180.0;

/** Standard normal quantile at 1 - 5e-7. */
constexpr double bound_in_sigmas = 4.9;

/** \brief Expect that \p sum_of_squares is chi-squared with \p n degrees of freedom. */
inline void
expectChiSquared(double sum_of_squares, double n)
{
  ASSERT_GT(n, 1000.0);
  EXPECT_NEAR(sum_of_squares, n, bound_in_sigmas * std::sqrt(2.0 * n));
}

/** \brief Default options of a scene, without noise or offsets and with few rays. */
inline bayesian_icp::simulator::SimulationOptions
cleanOptions(const std::string& scene)
{
  auto options = bayesian_icp::simulator::defaultOptions(scene);
  options.sensor.noise = 0.0;
  options.sensor.camera.width = 160;
  options.sensor.camera.height = 120;
  options.sensor.lidar.azimuth_step = 2.0;
  options.sensor.lidar.ring_offset = 0.0;
  return options;
}

/** \brief One scan from the target's view. */
inline bayesian_icp::simulator::Scan
scanTarget(const bayesian_icp::simulator::SimulationOptions& options,
           std::uint32_t scan_number = 0)
{
  return scanScene(bayesian_icp::simulator::makeScene(options.scene),
                   options.sensor,
                   sensorPose(options.sensor.kind, options.target_view),
                   options.seed,
                   scan_number);
}
