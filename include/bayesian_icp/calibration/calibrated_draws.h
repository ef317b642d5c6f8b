/** \file
 * \brief Draws of the calibrated posterior: SGLD whose score is weighted such that the
 * spread is the calibrated covariance, and whose shape is that of the data.
 */
#pragma once

#include <bayesian_icp/calibration/calibrated_estimate.h>
#include <bayesian_icp/chains.h>

namespace bayesian_icp {

/** \brief Sum of the scores of some source points, as SurfaceScorer::batchScore() gives
 * it for the estimate's centre and residual scale.
 * \param[in] T_target_source the pose
 * \param[in] indices columns of the source, none twice
 * \param[out] total sum of their scores
 * \return how many of them have a usable patch */
using BatchScore = std::function<int(const Eigen::Isometry3d& T_target_source,
                                     const std::vector<std::size_t>& indices,
                                     Vector6d& total)>;

/** \brief Makes the score of one chain at a mode: it may keep buffers, but its answers
 * must depend on its arguments alone. */
using MakeBatchScore = std::function<BatchScore(const CalibratedEstimate&)>;

/** \brief One of several modes. */
struct CalibratedMode {
  CalibratedEstimate estimate;
  /** Logarithm of its share of the posterior, up to a constant common to all modes;
   * good to a factor of a few. */
  double log_weight = 0.0;
};

/** \brief The shares of the modes, exp(log_weight), normalised to sum 1. */
BAYESIAN_ICP_EXPORT std::vector<double>
sharesOf(const std::vector<CalibratedMode>& modes);

/** \brief Draw by stochastic gradient Langevin dynamics over mini-batches of the source
 * (the guarded pre-weighted score of docs/calibration.md).
 *
 * Chains have their own random streams, so that draws are bit-identical for every
 * number of threads. options.num_burn_in 0 and thinning 1 are automatic, and
 * initial_spread is not used: chains start from draws of the calibrated Gaussian. A
 * chain has diverged if a pose is not finite: the data and the prior leave a motion
 * free. */
BAYESIAN_ICP_EXPORT ChainSet
sampleCalibrated(const SurfaceScorer& scorer,
                 const Prior& prior,
                 const CalibratedEstimate& estimate,
                 const ChainOptions& options,
                 const ProgressCallback& progress = ProgressCallback());

/** \brief The same over several modes.
 *
 * Every mode has options.num_chains chains, one mode after another in the result and
 * named in ChainSet::modes, and a part of options.num_draws by its weight. A mode that
 * would get less than one draw a chain gets none and is left out. */
BAYESIAN_ICP_EXPORT ChainSet
sampleCalibrated(const SurfaceScorer& scorer,
                 const Prior& prior,
                 const std::vector<CalibratedMode>& modes,
                 const ChainOptions& options,
                 const ProgressCallback& progress = ProgressCallback());

/** \brief As for one mode, with any score. */
BAYESIAN_ICP_EXPORT ChainSet
sampleCalibrated(const MakeBatchScore& make_score,
                 const Prior& prior,
                 const CalibratedEstimate& estimate,
                 const ChainOptions& options,
                 const ProgressCallback& progress = ProgressCallback());

/** \brief Draw as if the likelihood were Gaussian about the mode, in
 * ProductCoordinates, with the exact prior: Metropolis steps that look at no points.
 *
 * Right however wide the prior is along motions that it alone holds. options as in
 * sampleCalibrated(); thinning is in units of three Metropolis steps. */
BAYESIAN_ICP_EXPORT ChainSet
sampleProductForm(const Prior& prior,
                  const CalibratedEstimate& estimate,
                  const ChainOptions& options,
                  const ProgressCallback& progress = ProgressCallback());

} // namespace bayesian_icp
