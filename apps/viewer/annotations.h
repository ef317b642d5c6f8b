/** \file
 * \brief What is written over the picture: legend, status, colour bar.
 */
#pragma once

#include "viewer/legend.h"
#include "viewer/window.h"

#include <string>
#include <vector>

namespace bayesian_icp::viewer {

/** \brief How many characters a line of a panel has room for, beside the colour bar
 * if it has one. */
std::size_t
lineWidth(bool has_color_bar, const Window& window);

/** \brief Whether so many lines of legend and status leave a third of a panel's height
 * to what it shows. */
bool
hasRoomFor(std::size_t num_lines, const Window& window);

/** \brief Write lines into the upper left corner of a panel, under names that begin
 * with "legend". */
void
addLegend(const std::vector<LegendLine>& lines, int viewport, Window& window);

/** \brief The area of a panel that a legend, the status and a colour bar leave free;
 * at least the upper half but for the legend, however long the status is. */
PictureArea
areaBeside(std::size_t num_legend_lines,
           std::size_t num_status_lines,
           bool has_color_bar,
           const Window& window);

/** \brief Write what the registration came to along the lower edge of a panel. */
void
addStatus(const std::vector<LegendLine>& lines, int viewport, Window& window);

/** \brief Write x, y or z where an axis ends [m], in front of all that is drawn, under
 * a name that begins with \p id. */
void
addAxisName(std::size_t axis,
            const Eigen::Vector3d& end,
            const Color& color,
            const std::string& id,
            int viewport,
            Window& window);

/** \brief A bar with ticks in mm or m at the right of a panel, from 0 to \p maximum
 * [m], under a name that begins with "legend". */
void
addColorBar(double maximum, const Color& text_color, int viewport, Window& window);

} // namespace bayesian_icp::viewer
