#include "simulator/sensor_options.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

namespace bayesian_icp::simulator {

namespace {

/** \brief Throw unless \p good; the message reads "<name> is <value>, but must be ...".
 */
void
require(bool good, const std::string& name, double value, const std::string& allowed)
{
  if (good)
    return;
  std::ostringstream message;
  message << name << " is " << value << ", but must be " << allowed;
  throw std::invalid_argument(message.str());
}

void
requireWithin(const std::string& name, double value, double lowest, double highest)
{
  std::ostringstream allowed;
  allowed << "within " << lowest << " and " << highest;
  require(value >= lowest && value <= highest, name, value, allowed.str());
}

void
requireNotNegative(const std::string& name, double value)
{
  require(value >= 0.0 && std::isfinite(value), name, value, "a finite number >= 0");
}

void
requirePositive(const std::string& name, double value)
{
  require(value > 0.0 && std::isfinite(value), name, value, "a finite number > 0");
}

void
validateCamera(const DepthCameraOptions& camera)
{
  requireWithin("width", camera.width, 1, 8192);
  requireWithin("height", camera.height, 1, 8192);
  requireWithin("fov", camera.horizontal_fov, 0.1, 170.0);
  requireNotNegative("lateral-noise", camera.lateral_noise);
}

void
validateLidar(const LidarOptions& lidar)
{
  requireWithin("rings", lidar.rings, 1, 1024);
  requireWithin("min-elevation", lidar.min_elevation, -90.0, 90.0);
  requireWithin("max-elevation", lidar.max_elevation, lidar.min_elevation, 90.0);
  requireWithin("azimuth-step", lidar.azimuth_step, 0.01, 180.0);
  requireNotNegative("range-noise", lidar.range_noise);
  requireNotNegative("ring-offset", lidar.ring_offset);
  requireWithin("azimuth-phase", lidar.azimuth_phase, 0.0, 1.0);
}

} // namespace

SensorOptions
carLidar(int rings)
{
  require(rings == 16 || rings == 32 || rings == 64 || rings == 128,
          "rings",
          rings,
          "16, 32, 64 or 128");
  SensorOptions options;
  options.kind = SensorKind::Lidar;
  options.lidar.rings = rings;
  options.lidar.min_elevation = rings < 64 ? -15.0 : -25.0;
  options.lidar.max_elevation = rings < 64 ? 15.0 : 5.0;
  options.lidar.azimuth_step = rings < 64 ? 0.2 : 0.25;
  options.lidar.ring_offset = 0.01;
  options.lidar.azimuth_phase = 1.0;
  options.incidence_noise = 0.25;
  options.min_range = 1.0;
  options.max_range = 80.0;
  return options;
}

int
numRows(const SensorOptions& options)
{
  return options.kind == SensorKind::DepthCamera ? options.camera.height
                                                 : options.lidar.rings;
}

int
raysPerRow(const SensorOptions& options)
{
  if (options.kind == SensorKind::DepthCamera)
    return options.camera.width;
  // A step that divides the circle must not lose a ray to round-off.
  return static_cast<int>(std::floor(360.0 / options.lidar.azimuth_step + 1e-9));
}

double
readingSigma(const SensorOptions& options, double reading)
{
  if (options.kind == SensorKind::Lidar)
    return options.noise * options.lidar.range_noise;
  const double beyond = reading - 0.4;
  return options.noise * (0.0012 + 0.0019 * beyond * beyond);
}

double
incidenceFactor(const SensorOptions& options, double angle_of_incidence)
{
  constexpr double largest = 10.0;
  if (options.incidence_noise <= 0.0)
    return 1.0;
  const double cosine = std::max(std::cos(angle_of_incidence), 0.0);
  return std::min(std::pow(cosine, -options.incidence_noise), largest);
}

void
validate(const SensorOptions& options)
{
  validateCamera(options.camera);
  validateLidar(options.lidar);
  requireNotNegative("noise", options.noise);
  requireWithin("noise-correlation", options.noise_correlation, 0.0, 1.0);
  requireWithin(
      "noise-correlation-pixels", options.noise_correlation_pixels, 0.1, 100.0);
  requireWithin("incidence-noise", options.incidence_noise, 0.0, 4.0);
  if (options.quantisation == Quantisation::Step)
    requirePositive("quantisation", options.quantisation_step);
  if (options.quantisation == Quantisation::Kinect && options.kind == SensorKind::Lidar)
    throw std::invalid_argument(
        "quantisation 'kinect' is for a depth-camera, not a lidar");
  requireWithin("dropout-from", options.dropout_from, 0.0, 90.0);
  requireWithin("outliers", options.outliers, 0.0, 1.0);
  requireNotNegative("outlier-spread", options.outlier_spread);
  requireWithin("jitter", options.jitter, 0.0, 1.0);
  requirePositive("min-range", options.min_range);
  requirePositive("max-range", options.max_range);
  require(options.max_range > options.min_range,
          "max-range",
          options.max_range,
          "larger than min-range");
}

} // namespace bayesian_icp::simulator
