/** \file
 * \brief Short names of the values of an enumeration.
 */
#pragma once

#include <cstddef>

namespace bayesian_icp {

/** \brief The name of \p value among \p names, which are in the order of the values
 * 0, 1, ...; "unknown" beyond them. */
template <typename Enumeration, std::size_t num_names>
const char*
nameOf(Enumeration value, const char* const (&names)[num_names])
{
  const auto index = static_cast<std::size_t>(value);
  return index < num_names ? names[index] : "unknown";
}

} // namespace bayesian_icp
