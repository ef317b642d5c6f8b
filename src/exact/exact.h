/** \file
 * \brief Preset `exact`: from a pair of clouds to a posterior.
 */
#pragma once

#include "search/target.h"

#include <bayesian_icp/pipeline.h>

#include <functional>

namespace bayesian_icp {

/** \brief Sample the posterior, and add reasons for caution.
 *
 * The residuals are much larger than was stated, because the target is another one or
 * elsewhere. The source has no shape, so the nearest target points say nothing about
 * motions along it. Tukey's kernel leaves out nearly all points: on that plateau the
 * prior alone decides, and chains agree.
 * \param[in] source_points 3 x n, finite, source frame [m]; thinned to
 *            max_source_points
 * \param[in] target with what options.exact.residual needs
 * \param[in] initial_pose the starts are spread about it [m, rad]
 * \param[in] has_diverged whether a pose is so far out that its chain has to be stopped
 */
PosteriorEstimate
estimateExact(const Eigen::Matrix3Xd& source_points,
              const Target& target,
              const Prior& prior,
              const Vector6d& initial_pose,
              const Options& options,
              const std::function<bool(const Vector6d&)>& has_diverged,
              const ProgressCallback& progress);

} // namespace bayesian_icp
