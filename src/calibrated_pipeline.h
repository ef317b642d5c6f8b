/** \file
 * \brief Preset `calibrated`: from the points of both clouds to a posterior.
 */
#pragma once

#include <bayesian_icp/pipeline.h>

namespace bayesian_icp {

/** \brief As estimatePosterior(), which see, for preset `calibrated`. */
PosteriorEstimate
estimateCalibratedPosterior(const Eigen::Matrix3Xd& source_points,
                            const Eigen::Matrix3Xd& target_points,
                            const Vector6d& initial_pose,
                            const Options& options,
                            const ProgressCallback& progress);

/** \brief At most \p max_points of the points, chosen at random, in a random order:
 * any part of the result is a random choice as well. */
Eigen::Matrix3Xd
randomSubset(const Eigen::Matrix3Xd& points, int max_points, std::uint64_t seed);

} // namespace bayesian_icp
