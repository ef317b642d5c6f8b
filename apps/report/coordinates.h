/** \file
 * \brief The six coordinates of a pose as readers see them.
 */
#pragma once

#include <array>
#include <cstddef>

namespace bayesian_icp::app {

constexpr double degrees_per_radian = 57.295779513082320877;

inline constexpr std::array<const char*, 6> coordinate_names = {
    "x", "y", "z", "roll", "pitch", "yaw"};

constexpr bool
isAngle(int coordinate)
{
  return coordinate >= 3;
}

} // namespace bayesian_icp::app
