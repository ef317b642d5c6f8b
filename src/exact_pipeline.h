/** \file
 * \brief Preset `exact`: from the energy of the pose to chains of draws.
 */
#pragma once

#include <bayesian_icp/chains.h>
#include <bayesian_icp/options.h>
#include <bayesian_icp/pose_energy.h>

#include <functional>

namespace bayesian_icp {

/** \brief At most \p max_points of the points, evenly over their order. */
Eigen::Matrix3Xd
thinned(const Eigen::Matrix3Xd& points, std::size_t max_points);

/** \brief Sample \p energy.
 * \param[in] initial_pose the starts are spread about it [m, rad] */
ChainSet
sampleExact(const PoseEnergy& energy,
            const Vector6d& initial_pose,
            const Options& options,
            const std::function<bool(const Vector6d&)>& has_diverged,
            const ProgressCallback& progress);

} // namespace bayesian_icp
