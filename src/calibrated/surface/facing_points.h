/** \file
 * \brief Internal: the points that hold motions along which nearly all of a cloud
 * slides.
 */
#pragma once

#include "calibrated/surface/surface_model.h"

#include <Eigen/Core>

#include <vector>

namespace bayesian_icp {

/** \brief Indices into \p columns, ascending, of the points that face a rare motion:
 * one that few patches of the cloud hold, like that along a tunnel. They are on the
 * patches whose normals are clear (SurfacePatch::has_clear_normal) and within 45
 * degrees of the motion. Empty if there is no such motion, and if many patches face it.
 * Compare Gelfand et al., Geometrically Stable Sampling for the ICP Algorithm (2003).
 * \param[in] points 3 x n [m]
 * \param[in] columns of the points to choose from, finite
 * \param[in] model surface of the points */
std::vector<Eigen::Index>
pointsFacingRareMotions(const Eigen::Matrix3Xd& points,
                        const std::vector<Eigen::Index>& columns,
                        const SurfaceModel& model);

} // namespace bayesian_icp
