/** \file
 * \brief The chains of one run, and the modes that they are in.
 */
#pragma once

#include <bayesian_icp/draws.h>

#include <optional>
#include <vector>

namespace bayesian_icp {

/** \brief Chains that ended up in one mode of the density. */
struct ChainMode {
  /** Indices of the chains. */
  std::vector<int> members;
  /** log of the mode's share of the density, up to a constant common to all modes; an
   * estimate from a Gaussian. */
  double log_evidence = 0.0;
};

/** \brief What is known of draws that are particles, not chains (sampler/stein.h). */
struct ParticleReport {
  double discrepancy = 0.0;
  double variance_share = 0.0;
  int num_steps = 0;
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
  /** Of particles, of which each chain holds some. */
  std::optional<ParticleReport> particles;
};

} // namespace bayesian_icp
