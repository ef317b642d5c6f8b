/** \file
 * \brief Steps of calibrated draws, and corrections of their spread.
 */
#pragma once

#include "calibrated/draws/weighted_score.h"
#include "sampler/langevin.h"
#include "sampler/sampling.h"

namespace bayesian_icp {

/** \brief Plan steps such that draws are nearly independent and need no more queries
 * than allowed.
 *
 * If the score of a batch is so noisy that this needs too many steps, the draws follow
 * the shape of the data only in part, and that of the calibrated Gaussian otherwise.
 * \param[in,out] score whose shape gain is set */
StepPlan
planDraws(WeightedScore& score, Random& random);

/** \brief Map b linearly such that it has the covariance of the calibrated Gaussian,
 * over all chains and about its own mean. The spread of a direction changes by a factor
 * of at most 1.4. The mean does not change, so the effects of prior and shape on it
 * remain.
 * \param[in,out] paths positions (a, b), one path per chain */
void
spreadAsEstimated(const ProductCoordinates& coordinates, std::vector<Path>& paths);

/** \brief Make b Student's t about its mean over all chains. The deviation of each draw
 * is multiplied by its own random sqrt((nu - 2) / chi^2_nu), which keeps the
 * covariance.
 * \param[in] degrees_of_freedom nu; 0 changes nothing */
void
scaleAtRandom(const ProductCoordinates& coordinates,
              int degrees_of_freedom,
              Random& random,
              std::vector<Path>& paths);

} // namespace bayesian_icp
