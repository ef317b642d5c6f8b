/** \file
 * \brief Marginal densities by kernels, for plots.
 */
#pragma once

#include <Eigen/Core>

#include <string>

namespace bayesian_icp::evaluate {

/** \brief A density at evenly spaced places, scaled so that its largest value is 1. */
struct DensityCurve {
  Eigen::VectorXd places;
  Eigen::VectorXd heights;
};

/** \brief Gaussian kernels of Silverman's bandwidth, 0.9 min(sd, interquartile range /
 * 1.34) n^(-1/5); their sum is evaluated at 200 places from the 0.5 to the 99.5 %
 * quantile and three bandwidths beyond.
 * \param[in] values at least two, finite
 * \return a single peak of height 1 where all values (nearly) agree */
DensityCurve
densityOf(const Eigen::VectorXd& values);

} // namespace bayesian_icp::evaluate
