/** \file
 * \brief The report of a track: its trajectory and how sure it is, as a page.
 */
#pragma once

#include "track/track_command.h"

#include <string>

namespace bayesian_icp::app {

/** \brief A self-contained HTML page.
 * \throws plot::GnuplotError if gnuplot does not draw */
std::string
trackReportHtml(const TrackCommand& command, const Track& track);

} // namespace bayesian_icp::app
