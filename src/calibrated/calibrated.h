/** \file
 * \brief Preset `calibrated`: from the points of both clouds to a posterior.
 */
#pragma once

#include "calibrated/surface/prepared_surface.h"

#include <bayesian_icp/pipeline.h>

#include <functional>

namespace bayesian_icp {

/** \brief Returns the surface of a cloud, which it may have to make first. */
using SurfaceGiver = std::function<const PreparedSurface&()>;

/** \brief estimatePosterior() of preset `calibrated`. Surfaces are not requested if
 * another argument is invalid.
 * \param[in] source_surface of \p source_points
 * \param[in] target_surface of \p target_points */
PosteriorEstimate
estimateCalibratedPosterior(const Eigen::Matrix3Xd& source_points,
                            const Eigen::Matrix3Xd& target_points,
                            const SurfaceGiver& source_surface,
                            const SurfaceGiver& target_surface,
                            const Vector6d& initial_pose,
                            const Options& options,
                            const ProgressCallback& progress);

} // namespace bayesian_icp
