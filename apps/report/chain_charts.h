/** \file
 * \brief Charts that show whether the chains agree.
 */
#pragma once

#include "report/chart.h"
#include "report/draw_set.h"

#include <vector>

namespace bayesian_icp::app {

/** \brief For each coordinate the draws in their order, and below the histogram of each
 * chain's ranks among all draws (Vehtari et al. 2021). */
std::vector<Chart>
chainCharts(const DrawSet& draws);

} // namespace bayesian_icp::app
