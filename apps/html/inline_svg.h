/** \file
 * \brief gnuplot's SVG documents as parts of an HTML page.
 */
#pragma once

#include <string>

namespace bayesian_icp::html {

/** \brief An `<svg>` that scales with its place, for use inside a page: without what
 * belongs to documents, with ids that no other figure has, a title and a description
 * for those who cannot see it, and the page's text colour for all that gnuplot would
 * draw in black, so that it can be read on light and on dark pages.
 * \param[in] document as gnuplot's terminal svg writes it
 * \param[in] id of the figure, unique in the page: letters, digits and '-'
 * \param[in] title,description plain text; they are escaped here */
std::string
inlineSvg(const std::string& document,
          const std::string& id,
          const std::string& title,
          const std::string& description);

} // namespace bayesian_icp::html
