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

} // namespace bayesian_icp::app
