#include "simulator/sensor_options.h"

#include "simulator/option_fields.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace bayesian_icp::simulator {

namespace {

[[noreturn]] void
refuse(const std::string& name, double value, const std::string& allowed)
{
  std::ostringstream message;
  message << name << " is " << value << ", but must be " << allowed;
  throw std::invalid_argument(message.str());
}

std::string
textOf(const Range& range)
{
  std::ostringstream text;
  if (range.highest == not_negative.highest)
    text << "a finite number " << (range.is_open ? "> " : ">= ") << range.lowest;
  else
    text << "within " << range.lowest << " and " << range.highest;
  return text.str();
}

} // namespace

SensorOptions
carLidar(int rings)
{
  if (rings != 16 && rings != 32 && rings != 64 && rings != 128)
    refuse("rings", rings, "16, 32, 64 or 128");
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
  visitSensor(options, [](const OptionField& field, auto value) {
    if constexpr (std::is_arithmetic_v<decltype(value)>) {
      const auto number = static_cast<double>(value);
      const Range& range = field.range;
      if (!(number >= range.lowest && number <= range.highest) ||
          (range.is_open && number == range.lowest))
        refuse(field.name, number, textOf(range));
    }
  });
  if (options.quantisation == Quantisation::Step &&
      !(options.quantisation_step > 0.0 && std::isfinite(options.quantisation_step)))
    refuse("quantisation", options.quantisation_step, textOf(positive));
  if (options.quantisation == Quantisation::Kinect && options.kind == SensorKind::Lidar)
    throw std::invalid_argument(
        "quantisation 'kinect' is for a depth-camera, not a lidar");
  if (options.max_range <= options.min_range)
    refuse("max-range", options.max_range, "larger than min-range");
}

} // namespace bayesian_icp::simulator
