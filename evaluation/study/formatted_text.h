/** \file
 * \brief Numbers and words in the columns of a table.
 */
#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace bayesian_icp::evaluate {

/** \brief A text as printf() makes it, of at most 255 characters. */
template <typename... Values>
std::string
format(const char* pattern, Values... values)
{
  std::array<char, 256> text;
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

} // namespace bayesian_icp::evaluate
