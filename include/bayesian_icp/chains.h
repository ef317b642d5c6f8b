/** \file
 * \brief Independent chains on several threads: starts, burn-in, thinning, progress.
 */
#pragma once

#include <bayesian_icp/export.h>
#include <bayesian_icp/sgld.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace bayesian_icp {

/** \brief How many chains, how long, from where. */
struct ChainOptions {
  /** Number of independent chains, positive. */
  int num_chains = 4;
  /** Draws kept in total over all chains, at least one per chain; earlier chains take
   * the remainder. */
  int num_draws = 2000;
  /** Steps at the start of each chain that are not kept. */
  int num_burn_in = 0;
  /** Steps per kept draw, in each chain; positive. */
  int thinning = 1;
  /** Standard deviation of the chains' starts about the initial guess
   * (x, y, z, roll, pitch, yaw) [m, rad]; zero starts every chain at the guess. */
  Vector6d initial_spread = Vector6d::Zero();
  /** Seed of all random numbers; chain i uses stream i of this seed. */
  std::uint64_t seed = 1;
  /** OpenMP threads, 1024 at most; 0: as OpenMP would. Draws do not depend on it. */
  int num_threads = 0;

  /** \brief Number of draws that chain \p chain keeps. */
  int
  numDrawsOf(int chain) const
  {
    return num_draws / num_chains + (chain < num_draws % num_chains ? 1 : 0);
  }
};

/** \brief State of a run, as told to a progress callback. */
struct Progress {
  /** Chain that has just made a step, and its steps so far. */
  int chain;
  long chain_steps;
  /** Steps of all chains so far, and of the complete run. Both are 0 while preset
   * `calibrated` makes its estimate and while the chains of `exact` warm up: how many
   * steps they need is not known before, and more are added if the draws have not
   * mixed. */
  long steps;
  long total_steps;
  /** Canonical pose at which the chain is now [m, rad]; NaN while nothing is sampled.
   * Preset `calibrated` adjusts the spread of its draws when all are there, by a factor
   * of at most 1.4 in any direction, and makes them Student's t: its chains are shown
   * here before that. */
  Vector6d pose = Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
};

/** \brief Called after each step, by one thread at a time, not always the same one.
 * Returns false to cancel the run. An exception stops the run and reaches the caller.
 */
using ProgressCallback = std::function<bool(const Progress&)>;

/** \brief What the chains sample. */
struct SamplerTarget {
  /** Makes the stochastic gradient of one chain. */
  std::function<MiniBatchGradient(int chain)> make_gradient;
  /** Whether a pose is so far out that the chain has to be stopped. */
  RunsAway has_diverged;
  /** Whether gradients of different chains may be evaluated at once. */
  bool is_thread_safe = true;
};

/** \brief Draws of one chain. */
struct Chain {
  /** Kept draws, one canonical pose a row. Shorter than asked for if the chain diverged
   * or the run was cancelled. */
  PoseMatrix draws;
  /** Whether the chain was stopped because it ran away or became non-finite, or jumped
   * by more than half a turn in most of its steps. */
  bool diverged = false;
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

/** \brief Run Algorithm 1 in options.num_chains chains.
 *
 * Draws are bit-identical for every number of threads, because a thread owns whole
 * chains and each chain its own generator. Inside a parallel region of the caller it
 * runs on the calling thread. */
BAYESIAN_ICP_EXPORT ChainSet
runChains(const Vector6d& start,
          const SamplerTarget& target,
          const SgldOptions& sgld,
          const ChainOptions& options,
          const ProgressCallback& progress = ProgressCallback());

} // namespace bayesian_icp
