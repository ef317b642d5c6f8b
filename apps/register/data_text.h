/** \file
 * \brief What the clouds say about the pose, in print.
 */
#pragma once

#include <bayesian_icp/data_report.h>

#include <string>

namespace bayesian_icp::app {

/** \brief A table of directions, the noise that was found, support and flags; empty if
 * there is no report. */
std::string
dataText(const DataReport& report);

/** \brief "wrong basin, misfit"; empty if no flag is raised. */
std::string
flagNames(const DataFlags& flags);

/** \brief What determines the pose along a direction: "data", "weak" or "prior". */
const char*
holderOf(Observability observability);

/** \brief Standard deviation of the angle along a direction [rad]; NaN for a
 * translation. */
double
angularDeviation(const DataDirection& direction);

} // namespace bayesian_icp::app
