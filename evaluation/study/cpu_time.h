/** \file
 * \brief The processor time that this program has taken.
 */
#pragma once

#include <ctime>

namespace bayesian_icp::evaluate {

/** \brief Of all its threads [s]. */
inline double
cpuSeconds()
{
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

} // namespace bayesian_icp::evaluate
