#include "modes.h"
#include "run_state.h"

#include <bayesian_icp/langevin.h>
#include <bayesian_icp/metropolis.h>
#include <bayesian_icp/preconditioned_sampler.h>
#include <bayesian_icp/summary.h>

#include <algorithm>
#include <cmath>

namespace bayesian_icp {

namespace {

/** Pairs of gradients of all chains of a mode in one joint iteration. */
constexpr int num_joint_pairs = 40;
constexpr int min_joint_iterations = 2;
constexpr int max_joint_iterations = 8;
/** Metropolis steps from which the thinning is found, and their burn-in; the thinning
 * for acceptance 1, and the largest one. */
constexpr int num_pilot_steps = 90;
constexpr double pilot_thinning = 2.0, max_thinning = 60.0;
/** Effective draws, over all chains, below which an automatic thinning is doubled: as
 * an absolute number and as a share of the draws. How often that is done. */
constexpr double wanted_ess = 900.0, wanted_ess_share = 0.45;
constexpr int max_extensions = 3;

/** One run, from the starts to the draws. */
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
  measureEvidence();

  StepPlan
  startLangevin();

  StepPlan
  startMetropolis();

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
  /** One a mode. */
  std::vector<GaussianFit> fits_;
  int num_burn_in_ = 0;
  int thinning_ = 1;
  ChainSet result_;
};

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
    measureEvidence();
    startSampling();
    forEach([this](std::size_t i) { sample(i, num_burn_in_); });
    mergeOverlappingModes(result_);
    for (int i = 0; i < max_extensions && needsExtension(); ++i)
      extend();
  }
  result_.cancelled = run_.cancelled();
  return std::move(result_);
}

void
PreconditionedRun::warmUpAlone()
{
  std::vector<GaussianFit> fits(states_.size());
  std::vector<double> log_evidences(states_.size());
  forEach([&](std::size_t i) {
    const int chain = static_cast<int>(i);
    auto& state = states_[i];
    state.energy = target_.make_energy(chain);
    state.random = std::make_unique<Random>(options_.seed, i);
    const Vector6d start =
        state.energy->burnIn(state.energy->drawStart(*state.random), *state.random);
    fits[i] = fitTempered(*state.energy, start, *state.random, [&] {
      run_.reportWarmUp(chain);
      return !run_.stopped();
    });
    log_evidences[i] = logEvidence(*state.energy, fits[i].gaussian, *state.random);
  });
  if (run_.stopped())
    return;
  result_.modes = groupByMode(fits, log_evidences, *states_.front().energy);
  poolFits(fits);
  moveFromWorseModes(result_);
  fits_.resize(result_.modes.size());
}

void
PreconditionedRun::poolFits(const std::vector<GaussianFit>& fits)
{
  for (const auto& mode : result_.modes) {
    Vector6d mean = Vector6d::Zero();
    Matrix6d precision = Matrix6d::Zero();
    const double share = 1.0 / static_cast<double>(mode.members.size());
    for (const int member : mode.members) {
      const auto& gaussian = fits[static_cast<std::size_t>(member)].gaussian;
      mean += share * gaussian.mean();
      precision += share * gaussian.precision();
    }
    GaussianFit pooled;
    pooled.gaussian = Gaussian(mean, precision);
    fits_.push_back(pooled);
  }
}

void
PreconditionedRun::refineJointly()
{
  for (int i = 1; i <= max_joint_iterations; ++i)
    if (!refineOnce(i) || run_.stopped())
      return;
}

/** Returns whether another iteration is needed. */
bool
PreconditionedRun::refineOnce(int iteration)
{
  std::vector<RegressionSums> sums(states_.size());
  forEach([&](std::size_t i) {
    const std::size_t mode = modeOf(i);
    const int members = static_cast<int>(result_.modes[mode].members.size());
    sums[i] = collectGradients(*states_[i].energy,
                               fits_[mode],
                               (num_joint_pairs + members - 1) / members,
                               *states_[i].random);
    run_.reportWarmUp(static_cast<int>(i));
  });
  bool is_done = iteration >= min_joint_iterations;
  for (std::size_t mode = 0; mode < fits_.size(); ++mode) {
    RegressionSums total;
    for (const int member : result_.modes[mode].members)
      total += sums[static_cast<std::size_t>(member)];
    updateFit(total,
              iteration <= min_joint_iterations ? 1.0 : 0.6,
              states_.front().energy->priorPrecision(),
              fits_[mode]);
    is_done = is_done && fits_[mode].has_converged;
  }
  return !is_done;
}

void
PreconditionedRun::measureEvidence()
{
  std::vector<double> log_evidences(states_.size());
  forEach([&](std::size_t i) {
    log_evidences[i] =
        logEvidence(*states_[i].energy, fits_[modeOf(i)].gaussian, *states_[i].random);
  });
  for (auto& mode : result_.modes) {
    std::vector<double> of_members;
    for (const int member : mode.members)
      of_members.push_back(log_evidences[static_cast<std::size_t>(member)]);
    mode.log_evidence = logMeanExp(of_members);
  }
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

StepPlan
PreconditionedRun::startMetropolis()
{
  std::vector<double> acceptances(states_.size());
  forEach([&](std::size_t i) {
    auto& state = states_[i];
    const Gaussian& gaussian = fits_[modeOf(i)].gaussian;
    auto chain = std::make_unique<MetropolisChain>(
        gaussian, gaussian.draw(*state.random), *state.energy, *state.random);
    for (int step = 0; step < num_pilot_steps && !run_.stopped(); ++step)
      chain->step();
    acceptances[i] = chain->acceptance();
    state.sampling = std::move(chain);
    run_.reportWarmUp(static_cast<int>(i));
  });
  const double least = *std::min_element(acceptances.begin(), acceptances.end());
  StepPlan common;
  common.thinning = static_cast<int>(
      std::min(max_thinning, std::ceil(pilot_thinning / std::max(least, 1e-3))));
  return common;
}

void
PreconditionedRun::startSampling()
{
  const StepPlan common = sampler_.metropolis ? startMetropolis() : startLangevin();
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
  for (long step = 1; step <= num_steps && !run_.stopped(); ++step) {
    state.sampling->step();
    const Vector6d& position = state.sampling->position();
    chain.diverged = state.energy->hasDiverged(position);
    if (chain.diverged)
      break;
    const long sampled = step - num_burn_in;
    if (sampled > 0 && sampled % thinning_ == 0)
      chain.draws.row(num_kept++) =
          canonicalPose(target_.to_pose(position)).transpose();
    run_.reportStep(static_cast<int>(chain_index), ++state.num_steps);
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

std::size_t
PreconditionedRun::modeOf(std::size_t chain) const
{
  for (std::size_t mode = 0; mode < result_.modes.size(); ++mode)
    for (const int member : result_.modes[mode].members)
      if (member == static_cast<int>(chain))
        return mode;
  return 0;
}

} // namespace

ChainSet
runPreconditionedChains(const PreconditionedTarget& target,
                        const PreconditionedOptions& sampler,
                        const ChainOptions& options,
                        const ProgressCallback& progress)
{
  return PreconditionedRun(target, sampler, options, progress).run();
}

} // namespace bayesian_icp
