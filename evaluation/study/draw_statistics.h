/** \file
 * \brief How far draws are from draws of a reference: divergences and distances.
 */
#pragma once

#include <bayesian_icp/pose.h>

#include <optional>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Mean and covariance of draws as plain vectors (angles not circular). */
struct Moments {
  Vector6d mean = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
};

/** \param[in] draws at least two rows */
Moments
momentsOf(const PoseMatrix& draws);

/** \brief The draws with each angle shifted by full turns to within pi of \p centre. */
PoseMatrix
unwrapAbout(const Vector6d& centre, const PoseMatrix& draws);

/** \brief L with covariance = L L^T, lower triangular; empty if there is none. */
std::optional<Matrix6d>
factorOf(const Matrix6d& covariance);

/** \brief KL(p || q) of two Gaussians [nats]; infinite if q is degenerate. */
double
gaussianKl(const Moments& p, const Moments& q);

/** \brief The same of the marginals of coordinate \p k. */
double
gaussianKl(const Moments& p, const Moments& q, int k);

/** \brief How far apart two empirical distribution functions are. */
struct SampleDistance {
  /** Area between them: Wasserstein-1 distance, in the unit of the values. */
  double wasserstein = 0.0;
  /** Largest difference, in [0, 1]. */
  double kolmogorov_smirnov = 0.0;
};

/** \param[in] a, b samples, finite, in any order */
SampleDistance
distanceBetween(Eigen::VectorXd a, Eigen::VectorXd b);

/** \brief Energy score E|X - y| - E|X - X'| / 2 of draws X, mean over the outcomes y
 * (one per row, at least one); smaller is better. E|X - X'| is that of 400 of the
 * draws. Coordinates need a common scale: give all in units of some standard
 * deviations. */
double
energyScore(const PoseMatrix& draws, const PoseMatrix& outcomes);

/** \brief Statistics of at least one value; the median of an even number is the mean of
 * the middle two. */
double
median(std::vector<double> values);
double
mean(std::vector<double> values);
double
smallest(std::vector<double> values);
double
largest(std::vector<double> values);

} // namespace bayesian_icp::evaluate
