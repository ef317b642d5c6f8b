/** \file
 * \brief What the phases of a run of the preconditioned sampler work on: the warm-up
 * (preconditioned_warm_up.cpp), the learning of Metropolis chains
 * (preconditioned_metropolis.cpp), Stein particles (preconditioned_stein.cpp) and the
 * sampling (preconditioned_sampler.cpp).
 */
#pragma once

#include "exact/preconditioned_sampler.h"
#include "sampler/gaussian_fit.h"
#include "sampler/sampling.h"

#include <memory>
#include <utility>
#include <vector>

namespace bayesian_icp {

/** \brief One chain, from its warm-up to its draws. */
struct PreconditionedChain {
  std::unique_ptr<StochasticEnergy> energy;
  Random random;
  /** Of the chain's own warm-up, or of the best mode if the chain was moved there:
   * Metropolis chains start apart, so that R-hat sees where they disagree. */
  Gaussian start = Gaussian();
  std::unique_ptr<SamplingChain> sampler = nullptr;
  Path path = Path();
};

/** \brief One run. */
struct PreconditionedRun {
  PreconditionedRun(std::vector<std::unique_ptr<StochasticEnergy>> energies,
                    const ExactOptions& the_options,
                    const ChainOptions& the_chain_options,
                    const ProgressCallback& progress)
  : options(the_options)
  , chain_options(the_chain_options)
  , state(progress)
  {
    for (std::size_t i = 0; i < energies.size(); ++i)
      chains.push_back({std::move(energies[i]), Random(chain_options.seed, i)});
    result.chains.resize(chains.size());
  }

  /** \brief work(i) for the index of every chain. */
  template <typename Work>
  void
  forEachChain(const Work& work)
  {
    bayesian_icp::forEachChain(chain_options.num_chains,
                               chain_options.num_threads,
                               state,
                               [&](int i) { work(static_cast<std::size_t>(i)); });
  }

  ToPose
  toPoseOf(std::size_t i) const
  {
    return
        [&energy = *chains[i].energy](const Vector6d& x) { return energy.toPose(x); };
  }

  /** \brief Let the sampler of chain \p i make its steps. */
  void
  advance(std::size_t i, const Schedule& steps, Path& path)
  {
    bayesian_icp::advance(
        *chains[i].sampler, steps, toPoseOf(i), static_cast<int>(i), state, path);
  }

  /** \brief Index of the mode that chain \p i is in. */
  std::size_t
  modeOf(std::size_t i) const;

  const ExactOptions& options;
  const ChainOptions& chain_options;
  /** Of all chains, but that each has its own number of draws. */
  Schedule schedule;
  RunState state;
  std::vector<PreconditionedChain> chains;
  /** One per mode, in the order of the result's. */
  std::vector<GaussianFit> fits;
  ChainSet result;
};

/** \brief Fit a Gaussian with each chain alone, find the modes, and let the chains of
 * a mode refine its Gaussian together. */
void
warmUp(PreconditionedRun& run);

/** \brief If there are several modes, measure their weights.
 * \param[in] gaussians one per chain */
void
measureEvidence(const std::vector<Gaussian>& gaussians, PreconditionedRun& run);

/** \brief Merge modes whose draws turn out to overlap. */
void
mergeOverlappingModes(ChainSet& set);

/** \brief Make the samplers, let them learn a common proposal, and freeze it.
 * \return the thinning that makes draws nearly independent */
int
startMetropolis(PreconditionedRun& run);

/** \brief Let Stein particles start as Langevin chains do, and move until they rest. */
void
sampleParticles(PreconditionedRun& run);

} // namespace bayesian_icp
