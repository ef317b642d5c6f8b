/** \file
 * \brief Preset `calibrated`: from the points of both clouds to a posterior.
 */
#pragma once

#include <bayesian_icp/pipeline.h>

namespace bayesian_icp {

/** \brief estimatePosterior() of preset `calibrated`. Surfaces are not made if another
 * argument is invalid. */
PosteriorEstimate
estimateCalibratedPosterior(const PreparedCloud& source,
                            const PreparedCloud& target,
                            const Vector6d& initial_pose,
                            const Options& options,
                            const ProgressCallback& progress);

} // namespace bayesian_icp
