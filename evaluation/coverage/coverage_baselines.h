/** \file
 * \brief What others make of a registration's uncertainty, for the coverage study.
 *
 * All that have a covariance combine with the case's prior as a calibrated user would:
 * the method's information and the prior's add up in twists about the moved source's
 * centroid, and the mean is one Newton step from the method's pose. At most 2000 source
 * points are registered, a random choice, unless said otherwise. All use one thread and
 * leave MethodResult::seconds to the caller.
 */
#pragma once

#include "coverage/coverage_methods.h"

#include <vector>

namespace bayesian_icp::evaluate {

/** \brief In this order:
 * - `naive`: point-to-point ICP with the prior; sigma^2 H^-1, sigma^2 the residuals'
 *   variance, every point independent;
 * - `closed-form`: point-to-plane ICP with the prior from there; Censi's covariance,
 *   sigma from the residuals' median;
 * - `point-to-point-sandwich`: the pose of `naive`; scores clustered in space and
 *   curvature by secants;
 * - `gicp-hessian`: PCL's GICP from the prior's mean; the inverse of its Hessian, in
 * which a point is known to 1 m in its plane and 0.03 m across, whatever the scene;
 * - `gicp`: PCL's GICP as it comes, but with 50 iterations, from the prior's mean and
 *   with all source points; a pose only;
 * - `icp`: PCL's ICP from the prior's mean; a pose only. */
std::vector<CoverageMethod>
baselineMethods();

} // namespace bayesian_icp::evaluate
