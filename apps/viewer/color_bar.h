/** \file
 * \brief The scale of the colours of standard deviations.
 */
#pragma once

#include "viewer/window.h"

namespace bayesian_icp::viewer {

/** \brief A bar with ticks in mm or m at the right of a panel, from 0 to \p maximum
 * [m], under a name that begins with "legend". */
void
addColorBar(double maximum, const Color& text_color, int viewport, Window& window);

} // namespace bayesian_icp::viewer
