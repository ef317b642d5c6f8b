/** \file
 * \brief Pictures of the two clouds before and after the registration.
 */
#pragma once

#include "register/run.h"
#include "report/chart.h"

#include <vector>

namespace bayesian_icp::app {

/** \brief Both clouds in the target frame from above and from a side, with the source
 * at the initial guess and at the final transformation: four charts with equal scales
 * in metres. */
std::vector<Chart>
cloudCharts(const Run& run);

} // namespace bayesian_icp::app
