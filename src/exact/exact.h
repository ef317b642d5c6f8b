/** \file
 * \brief Preset `exact`: from the energy of the pose to chains of draws.
 */
#pragma once

#include "exact/pose_energy.h"
#include "sampler/chain_set.h"

#include <bayesian_icp/options.h>
#include <bayesian_icp/pipeline.h>

#include <functional>
#include <string>
#include <vector>

namespace bayesian_icp {

/** \brief At most \p max_points of the points, evenly over their order. */
Eigen::Matrix3Xd
thinned(const Eigen::Matrix3Xd& points, std::size_t max_points);

/** \brief Sample \p energy.
 * \param[in] initial_pose the starts are spread about it [m, rad] */
ChainSet
sampleExact(const PoseEnergy& energy,
            const Vector6d& initial_pose,
            const ExactOptions& options,
            const ChainOptions& chain_options,
            const std::function<bool(const Vector6d&)>& has_diverged,
            const ProgressCallback& progress);

/** \brief Root mean square distance of points from the plane that fits them best [m].
 */
double
thicknessOf(const Eigen::Matrix3Xd& points);

/** \brief Reasons for caution about an estimate.
 *
 * The residuals are much larger than was stated, because the target is another one or
 * elsewhere. The source has no shape, so the nearest target points say nothing about
 * motions along it. Tukey's kernel leaves out nearly all points: on that plateau the
 * prior alone decides, and chains agree.
 * \param[in] estimate of \p energy; without a finite mean there are no doubts
 * \param[in] thickness thicknessOf() the source [m]
 * \param[in] measurement_sigma as stated [m] */
std::vector<std::string>
doubtsAbout(const PoseEnergy& energy,
            const PosteriorEstimate& estimate,
            double thickness,
            double measurement_sigma);

} // namespace bayesian_icp
