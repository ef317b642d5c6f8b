/** \file
 * \brief Preset `paper`: Algorithm 1 in several independent chains.
 */
#pragma once

#include "paper/sgld.h"
#include "sampler/chain_set.h"
#include "sampler/mini_batch.h"

#include <bayesian_icp/correspondence.h>
#include <bayesian_icp/options.h>
#include <bayesian_icp/prior.h>

#include <functional>

namespace bayesian_icp {

/** \brief What the chains sample. */
struct SampledDensity {
  /** Makes the stochastic gradient of one chain. */
  std::function<MiniBatchGradient(int chain)> make_gradient;
  /** Whether a pose is so far out that the chain has to be stopped. */
  RunsAway has_diverged;
  /** Whether gradients of different chains may be evaluated at once. */
  bool is_thread_safe = true;
};

/** \brief Run Algorithm 1 in chains.num_chains chains, as \p options has it.
 *
 * Draws are bit-identical for every number of threads, because a thread owns whole
 * chains and each chain its own generator. Inside a parallel region of the caller it
 * runs on the calling thread. */
ChainSet
runChains(const Vector6d& start,
          const SampledDensity& density,
          const PaperOptions& options,
          const ChainOptions& chains,
          const ProgressCallback& progress = ProgressCallback());

/** \brief Gradient of -log posterior of the pose for one chain, estimated from the next
 * mini-batch: weight times the mean gradient, eqs. (2) and (3), plus the prior's, eqs.
 * (6) and (7). It owns the chain's mini-batches and buffers.
 * \param[in] source_points 3 x n, source frame [m]; must outlive the gradient, like
 *            \p search and \p prior, which it only reads
 * \param[in] search finds correspondences in the target
 * \param[in] prior of the pose
 * \param[in] weight N / sigma^2 [1/m^2]
 * \param[in] mini_batches of this chain */
MiniBatchGradient
posteriorGradient(const Eigen::Matrix3Xd& source_points,
                  const CorrespondenceSearch& search,
                  const Prior& prior,
                  double weight,
                  const MiniBatches& mini_batches);

/** \brief Run Algorithm 1 on a pair of clouds.
 * \param[in] source_points 3 x n, finite, source frame [m]
 * \param[in] search finds correspondences in the target, within its gate
 * \param[in] initial_pose the chains start there, or about it [m, rad] */
ChainSet
samplePaper(const Eigen::Matrix3Xd& source_points,
            const CorrespondenceSearch& search,
            const Prior& prior,
            const Vector6d& initial_pose,
            const PaperOptions& options,
            const ChainOptions& chains,
            const RunsAway& has_diverged,
            const ProgressCallback& progress);

} // namespace bayesian_icp
