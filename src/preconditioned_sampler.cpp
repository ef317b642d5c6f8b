#include "modes.h"
#include "run_state.h"

#include <bayesian_icp/langevin.h>
#include <bayesian_icp/preconditioned_sampler.h>

#include <algorithm>

namespace bayesian_icp {

namespace {

/** Pairs of gradients of all chains of a mode in one joint iteration. */
constexpr int num_joint_pairs = 40;
constexpr int min_joint_iterations = 2;
constexpr int max_joint_iterations = 8;

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

  void
  planSampling();

  void
  sample(std::size_t chain);

  std::size_t
  modeOf(std::size_t chain) const;

  const PreconditionedTarget& target_;
  const PreconditionedOptions& sampler_;
  const ChainOptions& options_;
  int num_threads_;
  RunState run_;
  std::vector<ChainState> states_;
  /** One a mode, like the plans. */
  std::vector<GaussianFit> fits_;
  std::vector<StepPlan> plans_;
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
    planSampling();
    forEach([this](std::size_t i) { sample(i); });
    mergeOverlappingModes(result_);
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

void
PreconditionedRun::planSampling()
{
  int num_burn_in = options_.num_burn_in, thinning = options_.thinning;
  for (const auto& fit : fits_) {
    plans_.push_back(planSteps(fit,
                               states_.front().energy->numTerms(),
                               sampler_.batch_size,
                               sampler_.max_step_size));
    if (options_.num_burn_in == 0)
      num_burn_in = std::max(num_burn_in, plans_.back().num_burn_in);
    if (options_.thinning == 1)
      thinning = std::max(thinning, plans_.back().thinning);
  }
  long total_steps = 0;
  for (int i = 0; i < options_.num_chains; ++i)
    total_steps += num_burn_in + static_cast<long>(thinning) * options_.numDrawsOf(i);
  run_.setTotalSteps(total_steps);
  for (auto& plan : plans_) {
    plan.num_burn_in = num_burn_in;
    plan.thinning = thinning;
  }
}

void
PreconditionedRun::sample(std::size_t chain_index)
{
  auto& state = states_[chain_index];
  const std::size_t mode = modeOf(chain_index);
  const StepPlan& plan = plans_[mode];
  const int num_draws = options_.numDrawsOf(static_cast<int>(chain_index));
  const long num_steps =
      plan.num_burn_in + static_cast<long>(plan.thinning) * num_draws;

  Chain& chain = result_.chains[chain_index];
  chain.draws.resize(num_draws, 6);
  Eigen::Index num_kept = 0;
  LangevinChain langevin(fits_[mode].gaussian.draw(*state.random), *state.random);
  for (long step = 1; step <= num_steps && !run_.stopped(); ++step) {
    langevin.step(plan, *state.energy, *state.random);
    chain.diverged = state.energy->hasDiverged(langevin.position());
    if (chain.diverged)
      break;
    const long sampled = step - plan.num_burn_in;
    if (sampled > 0 && sampled % plan.thinning == 0)
      chain.draws.row(num_kept++) =
          canonicalPose(target_.to_pose(langevin.position())).transpose();
    run_.reportStep(static_cast<int>(chain_index), step);
  }
  chain.draws.conservativeResize(num_kept, 6);
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
