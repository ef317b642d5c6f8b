/** \file
 * \brief How calibrated draws are made and corrected: steps and spread.
 */
#pragma once

#include "calibrated/draws/weighted_score.h"
#include "sampler/langevin.h"
#include "sampler/sampling.h"

namespace bayesian_icp {

/** \brief Plan steps such that draws are nearly independent and need no more queries
 * than allowed.
 *
 * If a batch's score is so noisy that this needs too many steps, the draws follow the
 * shape of the data only in part, and the calibrated Gaussian for the rest.
 * \param[in,out] score gets its shape gain */
StepPlan
planDraws(WeightedScore& score, Random& random);

/** \brief Map b linearly such that it has the covariance of the calibrated Gaussian,
 * over all chains and about its own mean. No direction's spread changes by more than a
 * factor of 1.4. The mean stays, and with it what prior and shape do to it.
 * \param[in,out] paths one per chain, of positions (a, b) */
void
spreadAsEstimated(const ProductCoordinates& coordinates, std::vector<Path>& paths);

/** \brief Make b Student's t about its mean over all chains. The deviation of each draw
 * is multiplied by its own sqrt((nu - 2) / chi^2_nu), which keeps the covariance.
 * \param[in] degrees_of_freedom nu; 0 changes nothing */
void
scaleAtRandom(const ProductCoordinates& coordinates,
              int degrees_of_freedom,
              Random& random,
              std::vector<Path>& paths);

} // namespace bayesian_icp
