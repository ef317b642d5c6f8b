#include "calibrated/draws/draw_plan.h"
#include "sampler/langevin.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp {

namespace {

/** Random streams of the plans, counting down, and of the draws' scales. Chains have
 * streams 0, 1, ... */
constexpr std::uint64_t plan_stream = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t scale_stream = plan_stream - (std::uint64_t(1) << 32);

/** The run at one mode. */
struct ModeRun {
  /** Each chain has a copy. */
  WeightedScore score;
  int degrees_of_freedom;
  /** Options with the number of draws of this mode. */
  ChainOptions chains;
  /** Steps with the burn-in and thinning that are used. */
  StepPlan steps;
  /** One per chain. */
  std::vector<Path> paths;
};

bool
hasGaussian(const ModeRun& mode)
{
  return mode.score.coordinates().gaussian().factor().allFinite();
}

/** Plan the steps of the mode's chains. */
void
plan(const CalibratedOptions& options,
     std::uint64_t stream,
     ModeRun& mode,
     RunState& run)
{
  if (!hasGaussian(mode))
    return;
  Random random(mode.chains.seed, stream);
  StepPlan& steps = mode.steps;
  steps = planDraws(mode.score, random);
  steps.num_burn_in = options.num_burn_in.valueOr(steps.num_burn_in);
  steps.thinning = options.thinning.valueOr(steps.thinning);
  run.addSteps(numStepsOf(mode.chains, steps.num_burn_in, steps.thinning));
}

ToPose
toPoseOf(const ProductCoordinates& coordinates)
{
  return [&coordinates](const Vector6d& z) {
    return poseOf(coordinates.pose(z).matrix());
  };
}

/** \p index is the chain's number in the run, \p chain that in its mode. */
void
sampleChain(int index, int chain, ModeRun& mode, RunState& run)
{
  Path& path = mode.paths[static_cast<std::size_t>(chain)];
  path.has_diverged = !hasGaussian(mode);
  if (path.has_diverged)
    return;
  Random random(mode.chains.seed, static_cast<std::uint64_t>(index));
  WeightedScore score = mode.score;
  const ProductCoordinates& coordinates = score.coordinates();
  LangevinChain langevin(
      mode.steps, coordinates.gaussian().draw(random), score, random);
  advance(langevin,
          {mode.steps.num_burn_in, mode.steps.thinning, mode.chains.numDrawsOf(chain)},
          toPoseOf(coordinates),
          index,
          run,
          path);
}

ChainSet
sample(std::vector<ModeRun>& modes,
       const CalibratedOptions& options,
       const ChainOptions& chains,
       const ProgressCallback& progress)
{
  RunState run(progress);
  for (std::size_t m = 0; m < modes.size(); ++m)
    plan(options, plan_stream - m, modes[m], run);
  const int num_chains = chains.num_chains * static_cast<int>(modes.size());
  forEachChain(num_chains, chains.num_threads, run, [&](int i) {
    sampleChain(i,
                i % chains.num_chains,
                modes[static_cast<std::size_t>(i / chains.num_chains)],
                run);
  });
  ChainSet result;
  Random random(chains.seed, scale_stream);
  for (ModeRun& mode : modes) {
    const ProductCoordinates& coordinates = mode.score.coordinates();
    spreadAsEstimated(coordinates, mode.paths);
    scaleAtRandom(coordinates, mode.degrees_of_freedom, random, mode.paths);
    for (const Path& path : mode.paths)
      result.chains.push_back(chainOf(path, toPoseOf(coordinates)));
  }
  result.cancelled = run.cancelled();
  return result;
}

} // namespace

BatchScore
scoresOf(const SurfaceScorer& scorer)
{
  return [&scorer](const CalibratedEstimate& estimate,
                   const Eigen::Isometry3d& T_target_source,
                   const std::vector<std::size_t>& indices,
                   PatchHints& hints,
                   Vector6d& total) {
    return scorer.batchScore(T_target_source,
                             estimate.centre,
                             estimate.residual_scale,
                             indices,
                             hints,
                             total);
  };
}

std::vector<double>
sharesOf(const std::vector<CalibratedMode>& modes)
{
  double largest = -std::numeric_limits<double>::infinity();
  for (const auto& mode : modes)
    largest = std::max(largest, mode.log_weight);
  std::vector<double> shares;
  double sum = 0.0;
  for (const auto& mode : modes) {
    shares.push_back(std::exp(mode.log_weight - largest));
    sum += shares.back();
  }
  for (double& share : shares)
    share /= sum;
  return shares;
}

ChainSet
sampleCalibrated(const BatchScore& score,
                 const HeldPrior& prior,
                 const std::vector<CalibratedMode>& modes,
                 const CalibratedOptions& options,
                 const ChainOptions& chains,
                 const ProgressCallback& progress)
{
  const std::vector<double> shares = sharesOf(modes);
  std::vector<ModeRun> runs;
  std::vector<ChainMode> sampled;
  for (std::size_t m = 0; m < modes.size(); ++m) {
    ChainOptions of_mode = chains;
    of_mode.num_draws = std::max(
        chains.num_chains, static_cast<int>(std::lround(shares[m] * chains.num_draws)));
    ChainMode mode;
    for (int i = 0; i < chains.num_chains; ++i)
      mode.members.push_back(static_cast<int>(runs.size()) * chains.num_chains + i);
    mode.log_evidence = modes[m].log_weight;
    sampled.push_back(mode);
    const CalibratedEstimate& estimate = modes[m].estimate;
    runs.push_back({WeightedScore(estimate, prior, score),
                    estimate.degrees_of_freedom,
                    of_mode,
                    StepPlan(),
                    std::vector<Path>(static_cast<std::size_t>(chains.num_chains))});
  }
  ChainSet result = sample(runs, options, chains, progress);
  if (modes.size() > 1)
    result.modes = sampled;
  return result;
}

} // namespace bayesian_icp
