/** \file
 * \brief Preset `calibrated`: from the points of both clouds to a posterior.
 */
#pragma once

#include <bayesian_icp/pipeline.h>

namespace bayesian_icp {

/** \brief As estimatePosterior(), for preset `calibrated`. */
PosteriorEstimate
estimateCalibratedPosterior(const Eigen::Matrix3Xd& source_points,
                            const Eigen::Matrix3Xd& target_points,
                            const Vector6d& initial_pose,
                            const Options& options,
                            const ProgressCallback& progress);

} // namespace bayesian_icp
