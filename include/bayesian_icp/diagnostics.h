/** \file
 * \brief Convergence diagnostics of Markov chains, after Vehtari, Gelman, Simpson,
 * Carpenter, Buerkner: Rank-normalization, folding, and localization: An improved R-hat
 * (Bayesian Analysis 2021), as in R's package posterior 1.4.0.
 *
 * Every function on draws takes one scalar quantity as a matrix (draws per chain) x
 * (chains). One chain is enough, because every chain is split into two halves; the
 * middle draw of an odd number is left out. No function throws. The result is NaN where
 * it is undefined: for NaN, infinite or constant input, and for too few draws.
 */
#pragma once

#include <bayesian_icp/export.h>

#include <Eigen/Core>

namespace bayesian_icp {

/** \brief Rank-normalised split R-hat: the larger of the bulk and the folded value.
 * \return 1 for chains that agree; infinity for chains that never move but differ; NaN
 * with fewer than four draws in a chain, and if all draws are equally far from their
 * median */
BAYESIAN_ICP_EXPORT double
rhat(const Eigen::MatrixXd& draws);

/** \brief Effective sample size of the rank-normalised split chains.
 * \return at most S log10(S) for S draws in total; NaN with fewer than six draws in a
 * chain */
BAYESIAN_ICP_EXPORT double
bulkEss(const Eigen::MatrixXd& draws);

/** \brief The smaller effective sample size of the 5 % and the 95 % quantile.
 * \return at most S log10(S) for S draws in total; NaN with fewer than six draws in a
 * chain, and if 5 % of the draws or more share the largest value */
BAYESIAN_ICP_EXPORT double
tailEss(const Eigen::MatrixXd& draws);

/** \brief Monte Carlo standard error of the mean, in the unit of the draws.
 * \return NaN with fewer than six draws in a chain */
BAYESIAN_ICP_EXPORT double
mcseMean(const Eigen::MatrixXd& draws);

/** \brief Quantile of a set of values by linear interpolation (R's type 7).
 * \param[in] values in any order
 * \param[in] probability in [0, 1]
 * \return NaN without values, with a NaN or infinite value, or for a probability
 * outside [0, 1] */
BAYESIAN_ICP_EXPORT double
quantile(const Eigen::VectorXd& values, double probability);

} // namespace bayesian_icp
