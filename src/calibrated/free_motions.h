/** \file
 * \brief Motions that the data leave to the prior, far along which the pose may be.
 */
#pragma once

#include "calibrated/calibrated_estimate.h"

namespace bayesian_icp {

/** \brief Precision that holds a pose along the free directions of an estimate, those
 * that keep nothing, to within \p tolerance [m]. */
Matrix6d
holdOfFree(const CalibratedEstimate& estimate, double tolerance);

/** \brief Turn the free directions so that the source stays on the surface along them.
 *
 * The source is moved to both sides along a direction, as far as the prior or its own
 * size lets it, and the other motions are fitted there. The direction then leads from
 * the one end to the other. A way whose ends do not fit is tried again at a third of
 * its length.
 *
 * \param[in] scorer of both clouds
 * \param[in] prior of the pose
 * \param[in] misfit of the contacts at the mode
 * \param[in,out] estimate with mode, metric, prior, keep and directions; the directions
 *                keep their unit displacement */
void
turnFreeDirections(const SurfaceScorer& scorer,
                   const Prior& prior,
                   double misfit,
                   int num_threads,
                   CalibratedEstimate& estimate);

} // namespace bayesian_icp
