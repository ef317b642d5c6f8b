/** \file
 * \brief Draws of the calibrated posterior: SGLD whose score is weighted such that the
 * spread is the calibrated covariance, and whose shape is that of the data.
 */
#pragma once

#include "calibrated/calibrated_estimate.h"
#include "sampler/chain_set.h"

#include <bayesian_icp/options.h>

namespace bayesian_icp {

/** \brief Sum of the scores of some source points about an estimate's mode, as
 * SurfaceScorer::batchScore() gives it for its centre and residual scale. Chains call
 * it at once: its answers must depend on its arguments alone.
 *
 * \param[in] T_target_source the pose
 * \param[in] indices columns of the source, none twice
 * \param[in,out] hints of one chain: whatever speeds up the next call, empty at first
 * \param[out] total sum of their scores
 * \return how many of them have a usable patch */
using BatchScore = std::function<int(const CalibratedEstimate& estimate,
                                     const Eigen::Isometry3d& T_target_source,
                                     const std::vector<std::size_t>& indices,
                                     PatchHints& hints,
                                     Vector6d& total)>;

/** \brief The scores that \p scorer gives, which must outlive them. */
BatchScore
scoresOf(const SurfaceScorer& scorer);

/** \brief One of several modes. */
struct CalibratedMode {
  CalibratedEstimate estimate;
  /** Logarithm of its share of the posterior, up to a constant common to all modes;
   * good to a factor of a few. */
  double log_weight = 0.0;
};

/** \brief The shares of the modes, exp(log_weight), normalised to sum 1. */
std::vector<double>
sharesOf(const std::vector<CalibratedMode>& modes);

/** \brief Draw by stochastic gradient Langevin dynamics over mini-batches of the
 * source (the guarded pre-weighted score of docs/calibration.md).
 *
 * Every mode has chains.num_chains chains, one mode after another in the result, and
 * a part of chains.num_draws by its weight. A mode that would get less than one draw
 * a chain gets none and is left out. With one mode ChainSet::modes stays empty.
 *
 * Chains have their own random streams, so that draws are bit-identical for every
 * number of threads. They start from draws of the calibrated Gaussian. A chain has
 * diverged if a pose is not finite: the data and the prior leave a motion free. Of \p
 * options burn-in and thinning are used. */
ChainSet
sampleCalibrated(const BatchScore& score,
                 const Prior& prior,
                 const std::vector<CalibratedMode>& modes,
                 const CalibratedOptions& options,
                 const ChainOptions& chains,
                 const ProgressCallback& progress = ProgressCallback());

} // namespace bayesian_icp
