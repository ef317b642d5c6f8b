/** \file
 * \brief Charts of the posterior: densities of the coordinates, and all pairs of them.
 */
#pragma once

#include "report/chart.h"
#include "report/draw_set.h"

#include <vector>

namespace bayesian_icp::app {

/** \brief The density of each coordinate with its mean and its 95 % interval. */
std::vector<Chart>
densityCharts(const DrawSet& draws);

/** \brief Draws of all pairs of coordinates, coloured by chain, and their correlations.
 * \param[in] covariance CovarianceConvention::Parameters */
Chart
pairChart(const DrawSet& draws, const Matrix6d& covariance);

} // namespace bayesian_icp::app
