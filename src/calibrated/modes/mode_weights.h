/** \file
 * \brief How much of the posterior each of several modes has.
 */
#pragma once

#include "calibrated/draws/calibrated_draws.h"

#include <vector>

namespace bayesian_icp {

/** \brief Set log_weight of modes of one registration and sort them by it.
 *
 * It is the Gaussian's integral times the prior, less the energy of the residuals above
 * that of the best mode, as far as this is above its own noise: E max(0, 1 - 4 V /
 * E^2), V its variance if each independent patch could as well have the opposite sign:
 * kappa_inf times the sum of the points' squared differences. (Variance over clusters
 * of points would take for noise what one place tells, as a mug's handle does.) A mode
 * of which this is not finite, as its clouds do not meet, has the least weight there
 * is.
 */
void
weighModes(const Prior& prior, std::vector<CalibratedMode>& modes);

} // namespace bayesian_icp
