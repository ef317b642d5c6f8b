#include "viewer/geometry/color_map.h"

#include "io/coordinates.h"
#include "io/numbers.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp::viewer {

namespace {

std::string
textOf(const Eigen::Vector3d& values)
{
  return io::textOf(values[0], 3) + ", " + io::textOf(values[1], 3) + ", " +
         io::textOf(values[2], 3);
}

} // namespace

double
niceMaximum(double value)
{
  if (!(value > 0.0))
    return 1e-6;
  // A value that is nice itself may be a rounding above it.
  constexpr double tolerance = 1.0 - 1e-12;
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0})
    if (value * tolerance <= factor * power)
      return factor * power;
  return 10.0 * power;
}

double
niceMagnification(double largest_deviation, double size)
{
  constexpr double largest_share = 0.05;
  double best = 1.0;
  for (const double factor : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0})
    if (factor * largest_deviation <= largest_share * size)
      best = factor;
  return best;
}

LengthUnit
unitFor(double length)
{
  return length < 0.1 ? LengthUnit{"mm", 1e-3} : LengthUnit{"m", 1.0};
}

std::string
textOfLengths(const Eigen::Vector3d& lengths)
{
  const LengthUnit unit = unitFor(lengths.maxCoeff());
  return textOf(lengths / unit.in_metres) + " " + unit.name;
}

std::string
textOfAngles(const Eigen::Vector3d& angles)
{
  return textOf(app::degrees_per_radian * angles) + " deg";
}

} // namespace bayesian_icp::viewer
