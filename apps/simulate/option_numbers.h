/** \file
 * \brief Numbers of the command line, with an error that names the option.
 */
#pragma once

#include "io/numbers.h"

#include <stdexcept>

namespace bayesian_icp::simulator {

using io::textOf;

/** \brief The number that is the whole of \p text.
 * \throws std::invalid_argument naming \p option if it is not one */
template <typename Number>
Number
numberOf(const std::string& text, const std::string& option)
{
  Number value{};
  if (!io::readNumber(text, value))
    throw std::invalid_argument("'" + text + "' is not a number of the kind that --" +
                                option + " takes");
  return value;
}

} // namespace bayesian_icp::simulator
