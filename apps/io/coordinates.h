/** \file
 * \brief The six coordinates of a pose as readers see them.
 */
#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace bayesian_icp::app {

inline constexpr double degrees_per_radian = 57.295779513082320877;

inline constexpr std::array<const char*, 6> coordinate_names = {
    "x", "y", "z", "roll", "pitch", "yaw"};

constexpr bool
isAngle(int coordinate)
{
  return coordinate >= 3;
}

/** \brief The unit in which lengths of a size are written. */
struct LengthUnit {
  const char* name;
  double per_metre;
};

/** \brief Metres from 0.1 m on, millimetres below, and for NaN. */
constexpr LengthUnit
unitFor(double length)
{
  return length >= 0.1 ? LengthUnit{"m", 1.0} : LengthUnit{"mm", 1e3};
}

/** \brief Its key in the files: "x_m", "yaw_rad". */
inline std::string
coordinateKey(std::size_t coordinate)
{
  return coordinate_names[coordinate] + std::string(coordinate < 3 ? "_m" : "_rad");
}

} // namespace bayesian_icp::app
