/** \file
 * \brief A gate on distances in the form that KdTree takes.
 */
#pragma once

#include <algorithm>
#include <limits>

namespace bayesian_icp {

/** \brief The square [m^2] of a gate \p max_distance [m], at most the largest
 * float. */
inline float
squaredGate(double max_distance)
{
  return static_cast<float>(
      std::min(max_distance * max_distance,
               static_cast<double>(std::numeric_limits<float>::max())));
}

} // namespace bayesian_icp
