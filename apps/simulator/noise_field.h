/** \file
 * \brief Noise of the readings that neighbouring rays share.
 */
#pragma once

#include "simulator/sensor_options.h"

#include <Eigen/Core>

#include <cstdint>

namespace bayesian_icp::simulator {

/** \brief A smooth random field over the rays of one scan: white noise blurred by a
 * Gaussian of SensorOptions::noise_correlation_pixels along rows and columns, scaled to
 * unit variance everywhere. Two rays k rows or columns apart have the correlation
 * exp(-k^2 / (4 pixels^2)), but for the kernel's end at three standard deviations. */
class NoiseField {
public:
  /** \brief Depends on the arguments only, not on the number of threads. Makes nothing
   * if SensorOptions::noise_correlation is zero. */
  NoiseField(const SensorOptions& options,
             std::uint64_t seed,
             std::uint32_t scan_number);

  /** \brief A standard normal number of which the part of the variance that
   * SensorOptions::noise_correlation says is the field's.
   * \param[in] independent standard normal, the ray's own */
  double
  mixed(double independent, int row, int column) const;

private:
  double correlation_;
  /** One entry a ray; empty if the correlation is zero. */
  Eigen::ArrayXXd field_;
};

} // namespace bayesian_icp::simulator
