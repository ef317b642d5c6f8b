/** \file
 * \brief Time stamps in nanoseconds: numbers of 64 bits keep seconds since 1970 to
 * 240 ns only.
 */
#pragma once

#include <cstdint>
#include <string_view>

namespace bayesian_icp::io {

/** \brief Time stamps are below it [s]: those of ROS have seconds of 32 bits. */
constexpr double time_limit = 2147483648.0;

/** \brief Read a decimal number of seconds with at most nine decimals, without loss.
 * \return whether it is one; \p nanoseconds is unchanged if not */
bool
readSeconds(std::string_view text, std::int64_t& nanoseconds);

/** \brief The time stamp with the fewest decimals that is the same number.
 * \param[in] seconds from 0 to below time_limit */
std::int64_t
nanosecondsOf(double seconds);

/** \brief The nearest number of seconds. */
double
secondsOf(std::int64_t nanoseconds);

} // namespace bayesian_icp::io
