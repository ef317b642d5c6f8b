/** \file
 * \brief Whether there is a screen to draw on.
 */
#pragma once

namespace bayesian_icp::viewer {

/** \brief Make sure that the X display answers; VTK, off-screen too, aborts the program
 * where none does.
 * \throws std::runtime_error that says what to do */
void
requireDisplay();

} // namespace bayesian_icp::viewer
