/** \file
 * \brief A gate on distances in the form that KdTree takes.
 */
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp {

/** \brief The largest float that is not above the square [m^2] of a gate
 * \p max_distance [m]: a float is within the one if it is within the other. */
inline float
squaredGate(double max_distance)
{
  constexpr float largest = std::numeric_limits<float>::max();
  const double square =
      std::min(max_distance * max_distance, static_cast<double>(largest));
  const auto rounded = static_cast<float>(square);
  return static_cast<double>(rounded) > square ? std::nextafter(rounded, 0.f) : rounded;
}

} // namespace bayesian_icp
