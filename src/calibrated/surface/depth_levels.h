/** \file
 * \brief Clouds whose depth is rounded to coarse levels, and what undoes the rounding.
 */
#pragma once

#include "calibrated/surface/surface_model.h"

#include <optional>
#include <vector>

namespace bayesian_icp {

/** \brief The points without the rounding of their readings, if exact patches show that
 * the cloud consists of parallel levels, as depth from integer disparities does. Each
 * point moves across its level, at random, at most half of the way to the nearer level
 * next to it.
 * \param[in] points 3 x n, finite [m]
 * \param[in] exact patches to which their points fit exactly
 * \param[in] num_neighbors of a neighbourhood: a level has as many points, on average
 */
std::optional<Eigen::Matrix3Xf>
spreadLevels(const Eigen::Matrix3Xf& points,
             const std::vector<SurfacePatch>& exact,
             int num_neighbors);

} // namespace bayesian_icp
