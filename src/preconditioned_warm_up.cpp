#include "modes.h"
#include "preconditioned_run.h"

namespace bayesian_icp {

namespace {

/** Pairs of gradients of all chains of a mode in one joint iteration. */
constexpr int num_joint_pairs = 40;
constexpr int min_joint_iterations = 2;
constexpr int max_joint_iterations = 8;

} // namespace

void
PreconditionedRun::warmUpAlone()
{
  std::vector<GaussianFit> fits(states_.size());
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
  });
  if (run_.stopped())
    return;
  result_.modes = groupByMode(fits, *states_.front().energy);
  measureEvidence([&](std::size_t i) -> const Gaussian& { return fits[i].gaussian; });
  poolFits(fits);
  std::vector<std::size_t> homes(states_.size());
  for (std::size_t i = 0; i < homes.size(); ++i)
    homes[i] = modeOf(i);
  moveFromWorseModes(result_);
  fits_.resize(result_.modes.size());
  for (std::size_t i = 0; i < homes.size(); ++i)
    starts_.push_back(homes[i] < fits_.size() ? fits[i].gaussian
                                              : fits_.front().gaussian);
}

/** Where there are several modes: what each of them weighs. */
void
PreconditionedRun::measureEvidence(
    const std::function<const Gaussian&(std::size_t chain)>& gaussianOf)
{
  if (result_.modes.size() < 2)
    return;
  std::vector<double> log_evidences(states_.size());
  forEach([&](std::size_t i) {
    log_evidences[i] =
        logEvidence(*states_[i].energy, gaussianOf(i), *states_[i].random);
  });
  sortByEvidence(log_evidences, result_.modes);
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

std::size_t
PreconditionedRun::modeOf(std::size_t chain) const
{
  for (std::size_t mode = 0; mode < result_.modes.size(); ++mode)
    for (const int member : result_.modes[mode].members)
      if (member == static_cast<int>(chain))
        return mode;
  return 0;
}

} // namespace bayesian_icp
