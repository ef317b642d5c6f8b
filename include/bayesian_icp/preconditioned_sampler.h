/** \file
 * \brief The sampler of preset `exact`: chains that warm up on their own, learn a
 * common preconditioner where they agree, and then sample with it.
 */
#pragma once

#include <bayesian_icp/chains.h>
#include <bayesian_icp/stochastic_energy.h>

#include <memory>
#include <vector>

namespace bayesian_icp {

/** \brief Whether chains make Metropolis steps in place of Langevin steps. */
enum class MetropolisUse {
  /** Where the gradient of a batch is so noisy that Langevin steps would need (nearly)
   * all terms. */
  Automatic,
  Never,
  Always
};

/** \brief Short name: "automatic", "never", "always". */
BAYESIAN_ICP_EXPORT const char*
toString(MetropolisUse use);

/** \brief How the steps are made. */
struct PreconditionedOptions {
  /** Terms a step; 0 is automatic. Not used by metropolis steps. */
  std::size_t batch_size = 0;
  /** Largest step size, in (0, 1]; 1 would be a Newton step. Longer steps bias the
   * draws of a rough density: docs/performance.md. */
  double max_step_size = 0.6;
  /** Steps on StochasticEnergy::fullEnergy(), asymptotically exact. */
  MetropolisUse metropolis = MetropolisUse::Automatic;
};

/** \brief Run the chains.
 *
 * Each chain draws a start, burns in and fits a Gaussian on its own. Chains whose
 * Gaussians agree form a mode; those of modes more than 10 nats worse than the best are
 * moved to it. The chains of a mode refine its Gaussian together, then sample with
 * Langevin steps; or all chains together learn a proposal of Metropolis steps, for all
 * modes, then freeze it and sample.
 *
 * Draws are bit-identical for every number of threads: what the chains share is put
 * together from their results in the order of the chains.
 *
 * \param[in] energies one per chain
 * \param[in] sampler how the steps are made
 * \param[in] options num_burn_in 0 and thinning 1 are automatic, so that draws are
 *            nearly independent; initial_spread is not used (the energies draw their
 *            starts)
 * \param[in] progress told of every step; returns false to cancel */
BAYESIAN_ICP_EXPORT ChainSet
runPreconditionedChains(std::vector<std::unique_ptr<StochasticEnergy>> energies,
                        const PreconditionedOptions& sampler,
                        const ChainOptions& options,
                        const ProgressCallback& progress = ProgressCallback());

} // namespace bayesian_icp
