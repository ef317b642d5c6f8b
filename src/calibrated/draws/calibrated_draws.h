/** \file
 * \brief Draws of the calibrated posterior by stochastic gradient Langevin dynamics.
 * Scores are weighted such that the draws have the calibrated covariance. The shape of
 * the draws is that of the likelihood.
 */
#pragma once

#include "calibrated/calibrated_estimate.h"
#include "sampler/chain_set.h"

#include <bayesian_icp/options.h>

namespace bayesian_icp {

/** \brief Sum of the scores of some points, as SurfaceScorer::batchScore() returns it
 * for an estimate's centre and residual scale. Chains call it from several threads. Its
 * result must depend on its arguments only.
 *
 * \param[in] T_target_source the pose
 * \param[in] indices of points, in the order of SurfaceScores, none twice
 * \param[in,out] hints hints of one chain, which speed up the next call; empty at first
 * \param[out] total sum of their scores
 * \return number of these points that have a usable patch */
using BatchScore = std::function<int(const CalibratedEstimate& estimate,
                                     const Eigen::Isometry3d& T_target_source,
                                     const std::vector<std::size_t>& indices,
                                     PatchHints& hints,
                                     Vector6d& total)>;

/** \brief The scores of \p scorer, which must outlive the returned function. */
BatchScore
scoresOf(const SurfaceScorer& scorer);

/** \brief One of several modes. */
struct CalibratedMode {
  CalibratedEstimate estimate;
  /** Logarithm of the mode's share of the posterior, up to a constant common to all
   * modes. The share is accurate to a factor of a few. */
  double log_weight = 0.0;
};

/** \brief The shares of the modes: exp(log_weight), normalised to sum 1. */
std::vector<double>
sharesOf(const std::vector<CalibratedMode>& modes);

/** \brief Draw by stochastic gradient Langevin dynamics over mini-batches of points
 * (with the weighted and guarded score of docs/calibration.md).
 *
 * Every mode has chains.num_chains chains and a share of chains.num_draws in proportion
 * to its weight, at least one for each chain. The result has one mode after another.
 * With one mode, ChainSet::modes stays empty.
 *
 * Each chain has its own random stream, so that draws are bit-identical for every
 * number of threads. Chains start from draws of the calibrated Gaussian. A chain has
 * diverged if a pose is not finite, which means that data and prior leave a motion
 * free. Only burn-in and thinning of \p options are used. */
ChainSet
sampleCalibrated(const BatchScore& score,
                 const HeldPrior& prior,
                 const std::vector<CalibratedMode>& modes,
                 const CalibratedOptions& options,
                 const ChainOptions& chains,
                 const ProgressCallback& progress = ProgressCallback());

} // namespace bayesian_icp
