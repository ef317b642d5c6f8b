/** \file
 * \brief Any text as text of an HTML page.
 */
#pragma once

#include <string>
#include <string_view>

namespace bayesian_icp::html {

/** \brief \p text fit for elements and for attributes in either quotes. What is not
 * UTF-8, and control characters other than tab and newline, which HTML does not allow,
 * become U+FFFD. */
std::string
escaped(std::string_view text);

} // namespace bayesian_icp::html
