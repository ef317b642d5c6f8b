/** \file
 * \brief Chart of how well the clouds hold each motion.
 */
#pragma once

#include "report/chart.h"

#include <bayesian_icp/data_report.h>

namespace bayesian_icp::app {

/** \brief For each direction of a report its standard deviation in the posterior and in
 * the prior, on a logarithmic scale: what the clouds have added is the way between. */
Chart
directionChart(const DataReport& report);

} // namespace bayesian_icp::app
