/** \file
 * \brief How calibrated draws are made and corrected: steps and spread.
 */
#pragma once

#include "calibrated/draws/weighted_score.h"
#include "sampler/langevin.h"
#include "sampler/sampling.h"

namespace bayesian_icp {

/** \brief Plan draws that are nearly independent and stay within the queries allowed.
 *
 * If a batch's score is so noisy that this would need too many steps, the draws follow
 * the shape of the data only in part, and the calibrated Gaussian for the rest.
 * \param[in,out] score gets its shape gain */
StepPlan
planDraws(WeightedScore& score, Random& random);

/** \brief Give b, over all chains and about its own mean, the covariance of the
 * calibrated Gaussian, by a linear map that changes no direction's spread by more than
 * a factor of 1.4. The effect of the prior and of the data's shape on the mean stays.
 * \param[in,out] paths one per chain, of positions (a, b) */
void
spreadAsEstimated(const ProductCoordinates& coordinates, std::vector<Path>& paths);

/** \brief Make b Student's t about its mean over all chains: multiply the
 * deviation of each draw by its own sqrt((nu - 2) / chi^2_nu), which leaves the
 * covariance as it is.
 * \param[in] degrees_of_freedom nu; 0 changes nothing */
void
scaleAtRandom(const ProductCoordinates& coordinates,
              int degrees_of_freedom,
              Random& random,
              std::vector<Path>& paths);

} // namespace bayesian_icp
