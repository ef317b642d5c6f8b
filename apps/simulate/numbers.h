/** \file
 * \brief Numbers as text, independent of the locale and without loss.
 */
#pragma once

#include <charconv>
#include <stdexcept>
#include <string>
#include <system_error>

namespace bayesian_icp {
namespace simulator {

/** \brief The shortest text that reads back as the same number. */
template <typename Number>
std::string
textOf(Number value)
{
  char buffer[64];
  const auto result = std::to_chars(buffer, buffer + sizeof(buffer), value);
  return std::string(buffer, result.ptr);
}

/** \brief The number that is the whole of \p text.
 * \throws std::invalid_argument naming \p option if it is not one */
template <typename Number>
Number
numberOf(const std::string& text, const std::string& option)
{
  Number value{};
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end)
    throw std::invalid_argument("'" + text + "' is not a number of the kind that --" +
                                option + " takes");
  return value;
}

} // namespace simulator
} // namespace bayesian_icp
