#include "exact/modes.h"
#include "exact/preconditioned_run.h"

namespace bayesian_icp {

namespace {

/** Pairs of gradients of all chains of a mode in one joint iteration. */
constexpr int num_joint_pairs = 40;
constexpr int min_joint_iterations = 2;
constexpr int max_joint_iterations = 8;

/** One Gaussian a chain. */
std::vector<GaussianFit>
fitAlone(PreconditionedRun& run)
{
  std::vector<GaussianFit> fits(run.chains.size());
  run.forEachChain([&](std::size_t i) {
    auto& chain = run.chains[i];
    const Vector6d start =
        chain.energy->burnIn(chain.energy->drawStart(chain.random), chain.random);
    fits[i] = fitTempered(*chain.energy, start, chain.random, [&] {
      run.state.reportWarmUp(static_cast<int>(i));
      return !run.state.stopped();
    });
  });
  return fits;
}

/** The mean of the members' Gaussians. */
GaussianFit
pooled(const ChainMode& mode, const std::vector<Gaussian>& gaussians)
{
  Vector6d mean = Vector6d::Zero();
  Matrix6d precision = Matrix6d::Zero();
  const double share = 1.0 / static_cast<double>(mode.members.size());
  for (const int member : mode.members) {
    const auto& gaussian = gaussians[static_cast<std::size_t>(member)];
    mean += share * gaussian.mean();
    precision += share * gaussian.precision();
  }
  GaussianFit fit;
  fit.gaussian = Gaussian(mean, precision);
  return fit;
}

/** Groups the chains by mode, and leaves the modes that are clearly worse. */
void
tellModesApart(const std::vector<GaussianFit>& fits, PreconditionedRun& run)
{
  std::vector<Gaussian> gaussians;
  for (const auto& fit : fits)
    gaussians.push_back(fit.gaussian);
  run.result.modes = groupByMode(fits, *run.chains.front().energy);
  measureEvidence(gaussians, run);
  for (const auto& mode : run.result.modes)
    run.fits.push_back(pooled(mode, gaussians));
  std::vector<std::size_t> homes;
  for (std::size_t i = 0; i < run.chains.size(); ++i)
    homes.push_back(run.modeOf(i));
  moveFromWorseModes(run.result);
  run.fits.resize(run.result.modes.size());
  for (std::size_t i = 0; i < homes.size(); ++i)
    run.chains[i].start =
        homes[i] < run.fits.size() ? gaussians[i] : run.fits.front().gaussian;
}

/** Returns whether another iteration is needed. */
bool
refineOnce(int iteration, PreconditionedRun& run)
{
  std::vector<RegressionSums> sums(run.chains.size());
  run.forEachChain([&](std::size_t i) {
    const std::size_t mode = run.modeOf(i);
    const int members = static_cast<int>(run.result.modes[mode].members.size());
    sums[i] = collectGradients(*run.chains[i].energy,
                               run.fits[mode],
                               (num_joint_pairs + members - 1) / members,
                               run.chains[i].random);
    run.state.reportWarmUp(static_cast<int>(i));
  });
  bool is_done = iteration >= min_joint_iterations;
  for (std::size_t mode = 0; mode < run.fits.size(); ++mode) {
    RegressionSums total;
    for (const int member : run.result.modes[mode].members)
      total += sums[static_cast<std::size_t>(member)];
    updateFit(total,
              iteration <= min_joint_iterations ? 1.0 : 0.6,
              run.chains.front().energy->priorPrecision(),
              run.fits[mode]);
    is_done = is_done && run.fits[mode].has_converged;
  }
  return !is_done;
}

} // namespace

std::size_t
PreconditionedRun::modeOf(std::size_t i) const
{
  for (std::size_t mode = 0; mode < result.modes.size(); ++mode)
    for (const int member : result.modes[mode].members)
      if (member == static_cast<int>(i))
        return mode;
  return 0;
}

void
measureEvidence(const std::vector<Gaussian>& gaussians, PreconditionedRun& run)
{
  if (run.result.modes.size() < 2)
    return;
  std::vector<double> log_evidences(run.chains.size());
  run.forEachChain([&](std::size_t i) {
    log_evidences[i] =
        logEvidence(*run.chains[i].energy, gaussians[i], run.chains[i].random);
  });
  sortByEvidence(log_evidences, run.result.modes);
}

void
warmUp(PreconditionedRun& run)
{
  const std::vector<GaussianFit> fits = fitAlone(run);
  if (run.state.stopped())
    return;
  tellModesApart(fits, run);
  for (int i = 1; i <= max_joint_iterations; ++i)
    if (!refineOnce(i, run) || run.state.stopped())
      return;
}

} // namespace bayesian_icp
