/** \file
 * \brief The sampler of preset `exact`: chains that warm up on their own, learn a
 * common preconditioner where they agree, and then sample with it.
 */
#pragma once

#include "sampler/chain_set.h"
#include "sampler/stochastic_energy.h"

#include <bayesian_icp/options.h>

#include <memory>
#include <vector>

namespace bayesian_icp {

/** \brief Run the chains.
 *
 * Each chain draws a start, burns in and fits a Gaussian on its own. Chains whose
 * Gaussians agree form a mode; those of modes more than 10 nats worse than the best
 * are moved to it. The chains of a mode refine its Gaussian together, then sample
 * with Langevin steps; or all chains together learn a proposal of Metropolis steps,
 * for all modes, then freeze it and sample; or Stein particles, divided among the
 * chains, start from it.
 *
 * Draws are bit-identical for every number of threads: what the chains share is put
 * together from their results in the order of the chains.
 *
 * \param[in] energies one per chain
 * \param[in] options how the steps are made, and how many; scale, residual and starts
 *            are the energies'
 * \param[in] chains how many chains and draws
 * \param[in] progress told of every step; returns false to cancel */
ChainSet
runPreconditionedChains(std::vector<std::unique_ptr<StochasticEnergy>> energies,
                        const ExactOptions& options,
                        const ChainOptions& chains,
                        const ProgressCallback& progress = ProgressCallback());

} // namespace bayesian_icp
