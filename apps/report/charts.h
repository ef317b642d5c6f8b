/** \file
 * \brief The charts of the report.
 */
#pragma once

#include "register/run.h"
#include "report/chart.h"
#include "report/draw_set.h"

#include <bayesian_icp/data_report.h>

#include <vector>

namespace bayesian_icp::app {

/** \brief The density of coordinate \p k with its mean and its 95 % interval. */
Chart
densityChart(const DrawSet& draws, int k);

/** \brief Draws of all pairs of coordinates, coloured by chain, and their correlations.
 * \param[in] covariance CovarianceConvention::Parameters */
Chart
pairChart(const DrawSet& draws, const Matrix6d& covariance);

/** \brief For each direction of a report its standard deviation in the posterior and in
 * the prior, on a logarithmic scale: what the clouds have added is the way between. */
Chart
directionChart(const DataReport& report);

/** \brief Whether the chains agree about coordinate \p k: the draws in their order, and
 * below the histogram of each chain's ranks among all draws (Vehtari et al. 2021). */
Chart
chainChart(const DrawSet& draws, int k);

/** \brief Both clouds in the target frame from above and from a side, with the source
 * at the initial guess and at the final transformation: four charts with equal scales
 * in metres. */
std::vector<Chart>
cloudCharts(const Run& run);

} // namespace bayesian_icp::app
