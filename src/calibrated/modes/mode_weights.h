/** \file
 * \brief How much of the posterior each of several modes has.
 */
#pragma once

#include "calibrated/draws/calibrated_draws.h"

#include <vector>

namespace bayesian_icp {

/** \brief Set log_weight of the modes of one registration, and sort them by it.
 *
 * The weight is the Gaussian's integral times the prior, times exp(-energy). E is the
 * energy of the residuals above the best mode's. It counts as far as it is above its
 * own noise: E max(0, 1 - 4 V / E^2). V is the variance of E if each independent patch
 * could as well have the opposite sign: kappa_inf times the sum of the points' squared
 * differences. (The variance over clusters of points would take for noise what a single
 * place shows, such as a mug's handle.) A mode whose weight is not finite, because its
 * clouds do not meet, gets the smallest possible weight.
 *
 * \param[in] region_of_cloud if not 0, points that meet the target in one of two modes
 *            only are heeded apart, as patches of this part of a cloud: they come into
 *            view together */
void
weighModes(const Prior& prior,
           double region_of_cloud,
           std::vector<CalibratedMode>& modes);

} // namespace bayesian_icp
