#include "modes.h"
#include "preconditioned_run.h"

#include <bayesian_icp/summary.h>

#include <algorithm>
#include <cmath>

namespace bayesian_icp {

namespace {

/** Effective draws, over all chains, below which an automatic thinning is doubled: as
 * an absolute number and as a share of the draws. How often that is done. */
constexpr double wanted_ess = 900.0, wanted_ess_share = 0.45;
constexpr int max_extensions = 3;

} // namespace

ChainSet
PreconditionedRun::run()
{
  const auto num_chains = static_cast<std::size_t>(options_.num_chains);
  result_.chains.resize(num_chains);
  for (auto& chain : result_.chains)
    chain.draws.resize(0, 6);
  states_.resize(num_chains);
  warmUpAlone();
  if (!run_.stopped())
    refineJointly();
  if (!run_.stopped()) {
    startSampling();
    measureEvidence(
        [this](std::size_t i) -> const Gaussian& { return fits_[modeOf(i)].gaussian; });
    forEach([this](std::size_t i) { sample(i, num_burn_in_); });
    mergeOverlappingModes(result_);
    for (int i = 0; i < max_extensions && needsExtension(); ++i)
      extend();
  }
  result_.cancelled = run_.cancelled();
  return std::move(result_);
}

/** Both return burn-in and thinning that serve all modes. */
StepPlan
PreconditionedRun::startLangevin()
{
  std::vector<StepPlan> plans;
  StepPlan common;
  for (const auto& fit : fits_) {
    plans.push_back(planSteps(fit,
                              states_.front().energy->numTerms(),
                              sampler_.batch_size,
                              sampler_.max_step_size));
    common.num_burn_in = std::max(common.num_burn_in, plans.back().num_burn_in);
    common.thinning = std::max(common.thinning, plans.back().thinning);
  }
  for (std::size_t i = 0; i < states_.size(); ++i) {
    auto& state = states_[i];
    const std::size_t mode = modeOf(i);
    state.sampling =
        std::make_unique<LangevinChain>(plans[mode],
                                        fits_[mode].gaussian.draw(*state.random),
                                        *state.energy,
                                        *state.random);
  }
  return common;
}

bool
PreconditionedRun::usesMetropolis() const
{
  if (sampler_.metropolis != MetropolisUse::Automatic)
    return sampler_.metropolis == MetropolisUse::Always;
  const auto num_terms = static_cast<double>(states_.front().energy->numTerms());
  return std::any_of(fits_.begin(), fits_.end(), [&](const GaussianFit& fit) {
    return termNoise(fit).maxCoeff() > num_terms;
  });
}

void
PreconditionedRun::startSampling()
{
  const StepPlan common = usesMetropolis() ? startMetropolis() : startLangevin();
  num_burn_in_ = options_.num_burn_in > 0 ? options_.num_burn_in : common.num_burn_in;
  thinning_ = options_.thinning > 1 ? options_.thinning : common.thinning;
  long total_steps = 0;
  for (int i = 0; i < options_.num_chains; ++i)
    total_steps += num_burn_in_ + static_cast<long>(thinning_) * options_.numDrawsOf(i);
  run_.addSteps(total_steps);
}

void
PreconditionedRun::sample(std::size_t chain_index, int num_burn_in)
{
  auto& state = states_[chain_index];
  const int num_draws = options_.numDrawsOf(static_cast<int>(chain_index));
  Chain& chain = result_.chains[chain_index];
  Eigen::Index num_kept = chain.draws.rows();
  const long num_steps = num_burn_in + static_cast<long>(thinning_) *
                                           (num_draws - static_cast<long>(num_kept));
  chain.draws.conservativeResize(num_draws, 6);
  const long steps_before = state.num_steps;
  state.num_steps += num_steps;
  for (long step = 1; step <= num_steps && !run_.stopped(); ++step) {
    state.sampling->step();
    const Vector6d& position = state.sampling->position();
    if (state.energy->hasDiverged(position)) {
      chain.diverged = true;
      break;
    }
    const long sampled = step - num_burn_in;
    if (sampled > 0 && sampled % thinning_ == 0)
      chain.draws.row(num_kept++) =
          canonicalPose(target_.to_pose(position)).transpose();
    run_.reportStep(static_cast<int>(chain_index), steps_before + step, [&] {
      return target_.to_pose(position);
    });
  }
  chain.draws.conservativeResize(num_kept, 6);
}

/** Whether one mode's chains fall short of what an automatic thinning is to reach. */
bool
PreconditionedRun::needsExtension() const
{
  if (options_.thinning > 1 || run_.stopped() || result_.modes.size() > 1)
    return false;
  const Summary summary = summarize(result_);
  if (summary.num_diverged_chains > 0)
    return false;
  const double wanted =
      std::min(wanted_ess, wanted_ess_share * static_cast<double>(summary.num_draws));
  for (const auto& coordinate : summary.coordinates)
    if (coordinate.rhat > max_rhat || coordinate.bulk_ess < wanted ||
        coordinate.tail_ess < wanted)
      return true;
  return false;
}

/** Keeps every other draw and makes up for the rest with twice the thinning. */
void
PreconditionedRun::extend()
{
  thinning_ *= 2;
  long more_steps = 0;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    PoseMatrix& draws = result_.chains[i].draws;
    const Eigen::Index half = draws.rows() / 2;
    for (Eigen::Index row = 0; row < half; ++row)
      draws.row(row) = draws.row(2 * row + 1).eval();
    more_steps += static_cast<long>(thinning_) * (draws.rows() - half);
    draws.conservativeResize(half, 6);
  }
  run_.addSteps(more_steps);
  forEach([this](std::size_t i) { sample(i, 0); });
}

ChainSet
runPreconditionedChains(const PreconditionedTarget& target,
                        const PreconditionedOptions& sampler,
                        const ChainOptions& options,
                        const ProgressCallback& progress)
{
  return PreconditionedRun(target, sampler, options, progress).run();
}

} // namespace bayesian_icp
