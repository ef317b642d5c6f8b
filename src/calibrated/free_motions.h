/** \file
 * \brief Motions that the data leave to the prior. The pose may be far off along them.
 */
#pragma once

#include "calibrated/calibrated_estimate.h"

namespace bayesian_icp {

/** \brief Precision that holds a pose to within \p tolerance [m] along the free
 * directions of an estimate, those with keep = 0. */
Matrix6d
holdOfFree(const CalibratedEstimate& estimate, double tolerance);

/** \brief Turn the free directions so that the source stays on the surface along them.
 *
 * The source is moved to both sides along a direction, as far as the prior or its own
 * size allows, and the other motions are fitted there. The direction then leads from
 * one end to the other. If an end does not fit, a third of the length is tried.
 *
 * \param[in] scorer of both clouds
 * \param[in] prior of the pose
 * \param[in] misfit Contacts::misfit at the mode
 * \param[in,out] estimate with mode, metric, prior, keep and directions; the directions
 *                keep their unit displacement */
void
turnFreeDirections(const SurfaceScorer& scorer,
                   const HeldPrior& prior,
                   double misfit,
                   int num_threads,
                   CalibratedEstimate& estimate);

} // namespace bayesian_icp
