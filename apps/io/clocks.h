/** \file
 * \brief What time it is: differences are how long something took.
 */
#pragma once

#include <chrono>
#include <ctime>

namespace bayesian_icp::io {

/** \brief Processor time of all threads of this program [s]. */
inline double
cpuSeconds()
{
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/** \brief Time by a steady clock [s]. */
inline double
wallSeconds()
{
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double>(now).count();
}

} // namespace bayesian_icp::io
