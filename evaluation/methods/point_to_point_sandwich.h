/** \file
 * \brief Godambe information of point-to-point ICP: what preset `calibrated` would be
 * without its surface.
 */
#pragma once

#include "methods/baseline_problem.h"

namespace bayesian_icp::evaluate {

/** \brief Information H J^-1 H of the pose in twists about the moved centroid, J the
 * covariance of the score with clusters in space, H its curvature with correspondences
 * made anew, less its noise.
 * \param[in] fit point-to-point, at its minimum
 * \param[in] noise of the target across its surface [m]: the shortest step */
GaussianInformation
pointToPointSandwich(const BaselineProblem& problem, const IcpFit& fit, double noise);

} // namespace bayesian_icp::evaluate
