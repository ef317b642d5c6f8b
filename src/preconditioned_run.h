/** \file
 * \brief One run of the preconditioned sampler: its state and its phases. The warm-up
 * is in preconditioned_warm_up.cpp, what Metropolis chains learn in
 * preconditioned_metropolis.cpp, the sampling in preconditioned_sampler.cpp.
 */
#pragma once

#include "run_state.h"

#include <bayesian_icp/langevin.h>
#include <bayesian_icp/metropolis.h>
#include <bayesian_icp/preconditioned_sampler.h>

#include <functional>
#include <memory>
#include <vector>

namespace bayesian_icp {

/** \brief One run, from the starts to the draws. */
class PreconditionedRun {
public:
  PreconditionedRun(const PreconditionedTarget& target,
                    const PreconditionedOptions& sampler,
                    const ChainOptions& options,
                    const ProgressCallback& progress)
  : target_(target)
  , sampler_(sampler)
  , options_(options)
  , num_threads_(numThreadsFor(options, target.is_thread_safe))
  , run_(progress)
  {}

  ChainSet
  run();

private:
  using MetropolisChains = std::vector<MetropolisChain*>;

  struct ChainState {
    std::unique_ptr<StochasticEnergy> energy;
    std::unique_ptr<Random> random;
    std::unique_ptr<SamplingChain> sampling;
    long num_steps = 0;
  };

  template <typename Work>
  void
  forEach(const Work& work)
  {
    forEachChain(options_.num_chains, num_threads_, run_, [&](int i) {
      work(static_cast<std::size_t>(i));
    });
  }

  void
  warmUpAlone();

  void
  poolFits(const std::vector<GaussianFit>& fits);

  void
  refineJointly();

  bool
  refineOnce(int iteration);

  void
  measureEvidence(const std::function<const Gaussian&(std::size_t chain)>& gaussianOf);

  StepPlan
  startLangevin();

  bool
  usesMetropolis() const;

  StepPlan
  startMetropolis();

  std::shared_ptr<const MetropolisProposal>
  firstProposal() const;

  std::shared_ptr<const MetropolisProposal>
  learnProposal(const PoseMatrix& draws, double walk_scale, Random& random) const;

  PoseMatrix
  walkAndJump(int num_steps, const MetropolisChains& chains);

  double
  learnTogether(const MetropolisChains& chains);

  void
  startSampling();

  void
  sample(std::size_t chain, int num_burn_in);

  bool
  needsExtension() const;

  void
  extend();

  std::size_t
  modeOf(std::size_t chain) const;

  const PreconditionedTarget& target_;
  const PreconditionedOptions& sampler_;
  const ChainOptions& options_;
  int num_threads_;
  RunState run_;
  std::vector<ChainState> states_;
  /** Of each chain's own warm-up, or of the best mode if the chain was moved there:
   * Metropolis chains start apart, so that R-hat sees where they disagree. */
  std::vector<Gaussian> starts_;
  /** One a mode. */
  std::vector<GaussianFit> fits_;
  int num_burn_in_ = 0;
  int thinning_ = 1;
  ChainSet result_;
};

} // namespace bayesian_icp
