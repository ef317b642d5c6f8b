/** \file
 * \brief Reference draws from a density: long Metropolis runs whose convergence is
 * shown, not assumed.
 */
#pragma once

#include "samplers/metropolis_runs.h"

#include <functional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Length and stopping rule of the runs. */
struct GoldOptions {
  /** There are two runs, each of this number of chains. They share the frozen proposal,
   * fitted to what both found, and nothing else. */
  int chains_per_run = 4;
  /** Steps of each chain in each of the annealed and the adaptive stages, and between
   * looks at the convergence. */
  int steps_per_round = 1000;
  /** CPU time after which the runs end, converged or not [s]. */
  double max_seconds = 60.0;
  /** Largest R-hat of all chains, and Kullback-Leibler divergence between the runs
   * (6-D, Gaussian moments, the larger direction) that count as converged. */
  double max_rhat = 1.01;
  double max_kl = 0.005;
  /** Smallest bulk and tail ESS that counts as converged: keeps the reference's own
   * error well below that of the draws it judges. */
  double min_ess = 4000.0;
  std::uint64_t seed = 20240701;
  int num_threads = 1;
};

/** \brief The reference. */
struct GoldStandard {
  /** Draws of all chains, run after run, thinned. */
  std::vector<PoseMatrix> chains;
  double rhat = 0.0;
  double kl_between_runs = 0.0;
  /** Smallest bulk and tail ESS of a coordinate, all chains together. */
  double bulk_ess = 0.0;
  double tail_ess = 0.0;
  double seconds = 0.0;
  bool has_converged = false;
};

/** \brief What the runs sample. */
struct GoldTarget {
  /** Makes the energy of one chain. */
  std::function<EnergyFunction()> make_energy;
  /** An over-dispersed start. */
  std::function<Vector6d(Random&)> draw_start;
  /** Typical width of the starts: the first proposals of the annealed walk. */
  Vector6d start_spread;
};

/** \brief Sample \p target: annealed random walks from over-dispersed starts, mixtures
 * fitted to what they find and then frozen, then mixture proposals and random walks in
 * turn until the runs agree.
 * \param[in] report gets one line per round */
GoldStandard
sampleGold(const GoldTarget& target,
           const GoldOptions& options,
           const std::function<void(const std::string&)>& report);

/** \brief Draws of all chains, one after the other. */
PoseMatrix
pooled(const std::vector<PoseMatrix>& chains);

} // namespace bayesian_icp::evaluate
