/** \file
 * \brief Weights of several modes: their shares of the posterior.
 */
#pragma once

#include "calibrated/draws/calibrated_draws.h"

#include <vector>

namespace bayesian_icp {

/** \brief Set log_weight of the modes of one registration, and sort them by it.
 *
 * The weight is the Gaussian's integral times the prior, times exp(-c E'). E is the
 * energy of the residuals above the best mode's. Only the part above its own noise
 * counts: E' = E max(0, 1 - 4 V / E^2). V is the variance of E if each independent
 * patch could as well have the opposite sign: kappa_inf times the sum of the points'
 * squared differences. (The variance over clusters of points would treat the evidence
 * of a single place, such as a mug's handle, as noise.) c is the scalar nearest to the
 * weights of the scores. A mode whose weight is not finite, because the clouds do not
 * meet there, gets the smallest possible weight.
 *
 * \param[in] region_of_cloud if not 0, points that meet the target in only one of two
 *            modes are counted separately, as patches of this fraction of a cloud,
 *            because they come into view together
 * \param[in] unseen of unseenPoints(), or empty. These points are no evidence. Then
 * fits may differ a little, because the views do, and the Gaussian's integral does not
 * count if all modes hold all motions. */
void
weighModes(const HeldPrior& prior,
           double region_of_cloud,
           const std::vector<std::vector<char>>& unseen,
           std::vector<CalibratedMode>& modes);

} // namespace bayesian_icp
