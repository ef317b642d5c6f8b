/** \file
 * \brief Covariances of a registration as they are published, without a prior's
 * information; and what preset `calibrated` would be without its surface.
 */
#pragma once

#include "methods/baseline_problem.h"

namespace bayesian_icp::evaluate {

/** \brief Point-to-plane ICP with the prior, from where point-to-point ICP ends; the
 * variance is a robust one of the distances to the planes. */
IcpFit
fitPlanes(const BaselineProblem& problem);

/** \brief A Gaussian of left twists (v, w) about \p centre, target frame [m, rad]. */
struct TwistGaussian {
  Eigen::Isometry3d mean = Eigen::Isometry3d::Identity();
  /** Not finite or not positive definite where the method has none. */
  Matrix6d covariance = Matrix6d::Zero();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
};

/** \brief Censi's covariance of point-to-point ICP, about its result.
 * \param[in] sigma noise of a point's coordinate [m]; NaN: from the residuals */
TwistGaussian
pointClosedForm(const CoverageCase& coverage_case, double sigma);

/** \brief The same of point-to-plane ICP: Prakhya's form.
 * \param[in] max_points of the source, chosen at random; 0: all */
TwistGaussian
planeClosedForm(const CoverageCase& coverage_case,
                double sigma,
                Eigen::Index max_points = 0);

/** \brief Variance of the residuals times the inverse of point-to-point ICP's Hessian.
 */
TwistGaussian
pointHessian(const CoverageCase& coverage_case);

/** \brief Inverse of the Hessian of PCL's GICP, about its result; from at most
 * \p max_points source points, chosen at random. */
TwistGaussian
gicpHessian(const CoverageCase& coverage_case,
            Eigen::Index max_points = max_source_points);

/** \brief Information H J^-1 H of the pose in twists about the moved centroid, J the
 * covariance of the score with clusters in space, H its curvature with correspondences
 * made anew, less its noise.
 * \param[in] fit point-to-point, at its minimum
 * \param[in] noise of the target across its surface [m]: the shortest step */
GaussianInformation
pointToPointSandwich(const BaselineProblem& problem, const IcpFit& fit, double noise);

} // namespace bayesian_icp::evaluate
