/** \file
 * \brief Preset `calibrated`: from the points of both clouds to a posterior.
 */
#pragma once

#include "calibrated/surface/prepared_surface.h"

#include <bayesian_icp/pipeline.h>

#include <functional>

namespace bayesian_icp {

/** \brief As estimatePosterior(), for preset `calibrated`.
 * \param[in] target_surface gives the target's surface, which it may have to make
 *            first; it is not asked for where the other arguments are wrong */
PosteriorEstimate
estimateCalibratedPosterior(
    const Eigen::Matrix3Xd& source_points,
    const Eigen::Matrix3Xd& target_points,
    const std::function<const PreparedSurface&()>& target_surface,
    const Vector6d& initial_pose,
    const Options& options,
    const ProgressCallback& progress);

} // namespace bayesian_icp
