/** \file
 * \brief How calibrated draws are taken, and what becomes of them: steps, spread,
 * poses.
 */
#pragma once

#include "weighted_score.h"

#include <bayesian_icp/langevin.h>

namespace bayesian_icp {

/** \brief How to take draws. */
struct DrawPlan {
  StepPlan steps;
  /** For WeightedScore::setShapeGain(). */
  Matrix6d shape_gain = Matrix6d::Identity();
};

/** \brief Plan draws that are nearly independent and stay within the queries allowed.
 *
 * Where a batch's score is so noisy that this asks for too many steps, the shape of the
 * data is followed only in part, and the calibrated Gaussian for the rest. */
DrawPlan
planDraws(WeightedScore& score,
          const WeightedScoreModel& model,
          const ChainOptions& options,
          Random& random);

/** \brief Give b, over all chains and about its own mean, the covariance of the
 * calibrated Gaussian, by a linear map that changes no direction's spread by more than
 * a factor of 1.4. What prior and shape of the data do to the mean stays.
 * \param[in,out] positions one chain an entry, one draw of (a, b) a column */
void
spreadAsEstimated(const ProductCoordinates& coordinates,
                  std::vector<Matrix6Xd>& positions);

/** \brief Make b Student's t about its mean over all chains: the deviation of each draw
 * times sqrt((nu - 2) / chi^2_nu) of its own, which leaves the covariance as it is.
 * \param[in] degrees_of_freedom nu; 0 changes nothing */
void
scaleAtRandom(const ProductCoordinates& coordinates,
              int degrees_of_freedom,
              Random& random,
              std::vector<Matrix6Xd>& positions);

/** \brief The poses of draws of (a, b). */
PoseMatrix
posesOf(const ProductCoordinates& coordinates, const Matrix6Xd& positions);

} // namespace bayesian_icp
