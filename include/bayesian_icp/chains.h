/** \file
 * \brief Independent chains on several threads: starts, burn-in, thinning, progress.
 */
#pragma once

#include <bayesian_icp/draws.h>
#include <bayesian_icp/export.h>
#include <bayesian_icp/sgld.h>

#include <functional>
#include <vector>

namespace bayesian_icp {

/** \brief What the chains sample. */
struct SamplerTarget {
  /** Makes the stochastic gradient of one chain. */
  std::function<MiniBatchGradient(int chain)> make_gradient;
  /** Whether a pose is so far out that the chain has to be stopped. */
  RunsAway has_diverged;
  /** Whether gradients of different chains may be evaluated at once. */
  bool is_thread_safe = true;
};

/** \brief Chains that ended up in one mode of the density. */
struct ChainMode {
  /** Indices of the chains. */
  std::vector<int> members;
  /** log of the mode's share of the density, up to a constant common to all modes; an
   * estimate from a Gaussian. */
  double log_evidence = 0.0;
};

/** \brief Chains of one run. */
struct ChainSet {
  std::vector<Chain> chains;
  bool cancelled = false;
  /** Modes that were told apart; empty if nobody looked (preset `paper`) or, with
   * preset `calibrated`, if there is one. */
  std::vector<ChainMode> modes;
  /** Chains whose own mode was clearly worse and that were moved to another one, and
   * how much worse the nearest of those modes was [nats]. */
  int num_moved_chains = 0;
  double moved_by_nats = 0.0;
};

/** \brief Run Algorithm 1 in chains.num_chains chains, as \p options has it.
 *
 * Draws are bit-identical for every number of threads, because a thread owns whole
 * chains and each chain its own generator. Inside a parallel region of the caller it
 * runs on the calling thread. */
BAYESIAN_ICP_EXPORT ChainSet
runChains(const Vector6d& start,
          const SamplerTarget& target,
          const PaperOptions& options,
          const ChainOptions& chains,
          const ProgressCallback& progress = ProgressCallback());

} // namespace bayesian_icp
