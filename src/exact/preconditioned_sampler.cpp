#include "exact/preconditioned_run.h"
#include "sampler/langevin.h"
#include "summary/estimates.h"

#include <bayesian_icp/summary.h>

#include <algorithm>

namespace bayesian_icp {

namespace {

/** Effective draws, over all chains, below which an automatic thinning is doubled: as
 * an absolute number and as a share of the draws. How often that is done. */
constexpr double wanted_ess = 900.0, wanted_ess_share = 0.45;
constexpr int max_extensions = 3;

bool
usesMetropolis(const PreconditionedRun& run)
{
  if (run.options.steps != ExactSteps::Automatic)
    return run.options.steps == ExactSteps::Metropolis;
  if (run.options.batch_size.isGiven())
    return false;
  const auto num_terms = static_cast<double>(run.chains.front().energy->numTerms());
  return std::any_of(run.fits.begin(), run.fits.end(), [&](const GaussianFit& fit) {
    return termNoise(fit).maxCoeff() > num_terms;
  });
}

/** Makes the samplers. Returns burn-in and thinning that serve all modes. */
Schedule
startLangevin(PreconditionedRun& run)
{
  std::vector<StepPlan> plans;
  Schedule common;
  for (const auto& fit : run.fits) {
    plans.push_back(
        planSteps(fit,
                  run.chains.front().energy->numTerms(),
                  static_cast<std::size_t>(run.options.batch_size.valueOr(0)),
                  run.options.max_step_size));
    common.num_burn_in = std::max(common.num_burn_in, plans.back().num_burn_in);
    common.thinning = std::max(common.thinning, plans.back().thinning);
  }
  for (std::size_t i = 0; i < run.chains.size(); ++i) {
    auto& chain = run.chains[i];
    const std::size_t mode = run.modeOf(i);
    chain.sampler =
        std::make_unique<LangevinChain>(plans[mode],
                                        run.fits[mode].gaussian.draw(chain.random),
                                        *chain.energy,
                                        chain.random);
  }
  return common;
}

void
startSampling(PreconditionedRun& run)
{
  Schedule found;
  if (usesMetropolis(run))
    found.thinning = startMetropolis(run);
  else
    found = startLangevin(run);
  run.schedule.num_burn_in = run.options.num_burn_in.valueOr(found.num_burn_in);
  run.schedule.thinning = run.options.thinning.valueOr(found.thinning);
  std::vector<Gaussian> gaussians;
  for (std::size_t i = 0; i < run.chains.size(); ++i)
    gaussians.push_back(run.fits[run.modeOf(i)].gaussian);
  measureEvidence(gaussians, run);
}

/** Until all draws are there. */
void
sample(PreconditionedRun& run)
{
  const auto scheduleOfChain = [&](std::size_t i) {
    Schedule schedule = run.schedule;
    schedule.num_draws = run.chain_options.numDrawsOf(static_cast<int>(i));
    return schedule;
  };
  long num_steps = 0;
  for (std::size_t i = 0; i < run.chains.size(); ++i)
    num_steps += scheduleOfChain(i).numSteps(run.chains[i].path.positions.cols());
  run.state.addSteps(num_steps);
  run.forEachChain([&](std::size_t i) {
    auto& chain = run.chains[i];
    run.advance(i, scheduleOfChain(i), chain.path);
    run.result.chains[i] = chainOf(chain.path, run.toPoseOf(i));
  });
}

/** Whether one mode's chains fall short of what an automatic thinning is to reach. */
bool
needsMoreSteps(const PreconditionedRun& run)
{
  if (run.state.stopped() || run.result.modes.size() > 1)
    return false;
  const Summary summary = summarize(run.result);
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
extend(PreconditionedRun& run)
{
  for (auto& chain : run.chains) {
    auto& positions = chain.path.positions;
    const Eigen::Index half = positions.cols() / 2;
    for (Eigen::Index i = 0; i < half; ++i)
      positions.col(i) = positions.col(2 * i + 1).eval();
    positions.conservativeResize(6, half);
  }
  run.schedule.num_burn_in = 0;
  run.schedule.thinning *= 2;
  sample(run);
}

} // namespace

ChainSet
runPreconditionedChains(std::vector<std::unique_ptr<StochasticEnergy>> energies,
                        const ExactOptions& options,
                        const ChainOptions& chains,
                        const ProgressCallback& progress)
{
  PreconditionedRun run(std::move(energies), options, chains, progress);
  warmUp(run);
  if (!run.state.stopped() && usesParticles(options.steps)) {
    sampleParticles(run);
  }
  else if (!run.state.stopped()) {
    startSampling(run);
    sample(run);
    mergeOverlappingModes(run.result);
    const int most = options.thinning.isGiven() ? 0 : max_extensions;
    for (int i = 0; i < most && needsMoreSteps(run); ++i)
      extend(run);
  }
  run.result.cancelled = run.state.cancelled();
  return std::move(run.result);
}

} // namespace bayesian_icp
