/** \file
 * \brief The tables of the report.
 */
#pragma once

#include "html/page.h"
#include "register/run.h"

namespace bayesian_icp::app {

/** \brief Mean, deviation, interval and diagnostics of each coordinate [m, rad], and
 * angles in degrees. */
html::Table
poseTable(const Summary& summary);

/** \brief Mean and deviation in each mode. */
html::Table
modesTable(const std::vector<Mode>& modes);

/** \brief How well the clouds hold each motion. */
html::Table
directionsTable(const std::vector<DataDirection>& directions);

/** \brief Files, sizes, times, versions. */
html::Table
runTable(const Run& run);

} // namespace bayesian_icp::app
