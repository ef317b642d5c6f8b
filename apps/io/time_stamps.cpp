#include "io/time_stamps.h"

#include "io/numbers.h"

#include <cmath>

namespace bayesian_icp::io {

namespace {

constexpr std::int64_t per_second = 1'000'000'000;
constexpr std::size_t num_decimals = 9;

} // namespace

bool
readSeconds(std::string_view text, std::int64_t& nanoseconds)
{
  const auto pieces = splitAt('.', text);
  std::string decimals(pieces.size() == 2 ? pieces[1] : std::string_view());
  if (pieces.size() > 2 || pieces[0].empty() || pieces[0].size() > num_decimals + 1 ||
      decimals.size() > num_decimals)
    return false;
  decimals.resize(num_decimals, '0');
  const std::string digits = std::string(pieces[0]) + decimals;
  return digits.find_first_not_of("0123456789") == std::string::npos &&
         readNumber(digits, nanoseconds);
}

std::int64_t
nanosecondsOf(double seconds)
{
  const double whole = std::floor(seconds);
  double parts = 1.0; // of a second
  while (parts < per_second &&
         whole + std::round((seconds - whole) * parts) / parts != seconds)
    parts *= 10.0;
  return std::llround(whole) * per_second +
         std::llround(std::round((seconds - whole) * parts) * (per_second / parts));
}

double
secondsOf(std::int64_t nanoseconds)
{
  return static_cast<double>(nanoseconds / per_second) +
         static_cast<double>(nanoseconds % per_second) / per_second;
}

} // namespace bayesian_icp::io
