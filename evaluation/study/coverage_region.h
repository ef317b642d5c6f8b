/** \file
 * \brief The smallest region of a posterior that holds a pose, and its probability.
 */
#pragma once

namespace bayesian_icp::evaluate {

/** \brief How a posterior's Mahalanobis distances are distributed. */
struct RegionShape {
  /** nu of Student's t distribution, scaled to its covariance, at least 3; 0 is a
   * Gaussian. */
  int degrees_of_freedom = 0;
  /** How many of the six directions have it; the others, which the prior holds, are
   * Gaussian. */
  int num_held = 6;
};

/** \brief Probability of a smaller squared Mahalanobis distance than \p nees: that of
 * the smallest ellipsoid about the mean with the shape of the covariance that has the
 * truth. Uniform if the posterior is right. NaN of NaN. */
double
regionOf(double nees, const RegionShape& shape = RegionShape());

} // namespace bayesian_icp::evaluate
