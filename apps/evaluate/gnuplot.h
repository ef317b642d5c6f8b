/** \file
 * \brief Pictures drawn by gnuplot.
 */
#pragma once

#include <string>

namespace bayesian_icp::evaluate {

/** \throws io::FileError if there is no gnuplot */
void
requireGnuplot();

/** \throws io::FileError */
void
makePlotFolder(const std::string& folder);

/** \brief A string of gnuplot's. */
std::string
quotedForGnuplot(const std::string& text);

/** \brief Lines that write one picture as SVG and PNG.
 * \param[in] file without its ending
 * \param[in] size "width, height" in pixels
 * \param[in] plot the commands that draw it */
std::string
pictures(const std::string& file, const std::string& size, const std::string& plot);

/** \brief Have a script drawn whose pictures are in \p folder.
 * \throws io::FileError if gnuplot does not draw it */
void
runGnuplot(const std::string& script, const std::string& folder);

} // namespace bayesian_icp::evaluate
