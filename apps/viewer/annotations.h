/** \file
 * \brief What is written over the picture: legend, status, colour bar.
 */
#pragma once

#include "viewer/legend.h"
#include "viewer/window.h"

#include <vector>

namespace bayesian_icp::viewer {

/** \brief How many characters a line of a panel has room for. */
std::size_t
lineWidth(const Window& window);

/** \brief Write lines into the upper left corner of a panel, under names that begin
 * with "legend". */
void
addLegend(const std::vector<LegendLine>& lines, int viewport, Window& window);

/** \brief The area of a panel that a legend, the status and a colour bar leave free. */
PictureArea
areaBeside(std::size_t num_lines, bool has_color_bar, const Window& window);

/** \brief Write what the registration came to along the lower edge of a panel. */
void
addStatus(const LegendLine& status, int viewport, Window& window);

/** \brief A bar with ticks in mm or m at the right of a panel, from 0 to \p maximum
 * [m], under a name that begins with "legend". */
void
addColorBar(double maximum, const Color& text_color, int viewport, Window& window);

} // namespace bayesian_icp::viewer
