/** \file
 * \brief Columns and lines of the printed report.
 */
#pragma once

#include <string>

namespace bayesian_icp::app {

/** \brief \p text with blanks behind it, \p width characters or more. */
std::string
leftAligned(std::string text, std::size_t width);

/** \brief \p text with at least one blank before it, \p width characters or more. */
std::string
rightAligned(const std::string& text, std::size_t width);

/** \brief A number in full if it is below 1e9.
 * \param[in] unknown stands for numbers that are not finite */
std::string
numberText(double value, int num_decimals, const std::string& unknown);

/** \brief A number, right aligned; "-" if it is not finite. */
std::string
cell(double value, int num_decimals, std::size_t width);

/** \brief Lines of at most 88 characters, those after the first indented. */
std::string
wrapped(const std::string& text);

} // namespace bayesian_icp::app
