#include "../run_state.h"
#include "draw_plan.h"
#include "weighted_score.h"

#include <bayesian_icp/langevin.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

namespace bayesian_icp {

namespace {

/** Of the plans' random numbers, downwards, and of the draws' scales; chains have
 * streams 0, 1, ... */
constexpr std::uint64_t plan_stream = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t scale_stream = plan_stream - (std::uint64_t(1) << 32);

/** What is drawn at one mode. */
struct ModeRun {
  ModeRun(const CalibratedEstimate& estimate, const Prior& prior, int draws)
  : model(estimate, prior)
  , num_draws(draws)
  {}

  WeightedScoreModel model;
  int num_draws;
  DrawPlan plan;
  /** Draws of each chain, one a column. */
  std::vector<Matrix6Xd> positions;
};

/** One run over one mode or several. */
class CalibratedRun {
public:
  CalibratedRun(const MakeBatchScore& make_score,
                const ChainOptions& options,
                const ProgressCallback& progress)
  : make_score_(make_score)
  , options_(options)
  , run_(progress)
  {}

  void
  addMode(const CalibratedEstimate& estimate, const Prior& prior, int num_draws)
  {
    modes_.push_back(std::make_unique<ModeRun>(estimate, prior, num_draws));
    modes_.back()->positions.resize(static_cast<std::size_t>(options_.num_chains));
  }

  ChainSet
  run()
  {
    const int num_chains = options_.num_chains * static_cast<int>(modes_.size());
    chains_.resize(static_cast<std::size_t>(num_chains));
    planAll();
    forEachChain(num_chains,
                 numThreadsFor(options_.num_threads, num_chains),
                 run_,
                 [&](int i) { sampleChain(i); });
    ChainSet result;
    auto chain = chains_.begin();
    Random random(options_.seed, scale_stream);
    for (const auto& mode : modes_) {
      const ProductCoordinates& coordinates = mode->model.coordinates;
      spreadAsEstimated(coordinates, mode->positions);
      scaleAtRandom(coordinates,
                    mode->model.estimate.degrees_of_freedom,
                    random,
                    mode->positions);
      for (const Matrix6Xd& positions : mode->positions)
        (chain++)->draws = posesOf(coordinates, positions);
    }
    result.chains = std::move(chains_);
    result.cancelled = run_.cancelled();
    return result;
  }

private:
  void
  planAll()
  {
    long total_steps = 0;
    for (std::size_t m = 0; m < modes_.size(); ++m) {
      ModeRun& mode = *modes_[m];
      if (!mode.model.coordinates.gaussian().factor().allFinite())
        continue;
      Random random(options_.seed, plan_stream - m);
      WeightedScore score(mode.model, make_score_(mode.model.estimate));
      mode.plan = planDraws(score, mode.model, options_, random);
      for (int i = 0; i < options_.num_chains; ++i)
        total_steps += numSteps(mode, i);
    }
    run_.addSteps(total_steps);
  }

  int
  numDraws(const ModeRun& mode, int chain) const
  {
    ChainOptions options = options_;
    options.num_draws = mode.num_draws;
    return options.numDrawsOf(chain);
  }

  long
  numSteps(const ModeRun& mode, int chain) const
  {
    return mode.plan.steps.num_burn_in +
           static_cast<long>(mode.plan.steps.thinning) * numDraws(mode, chain);
  }

  void
  sampleChain(int index)
  {
    ModeRun& mode = *modes_[static_cast<std::size_t>(index / options_.num_chains)];
    const int index_in_mode = index % options_.num_chains;
    Chain& chain = chains_[static_cast<std::size_t>(index)];
    const Gaussian& gaussian = mode.model.coordinates.gaussian();
    chain.diverged = !gaussian.factor().allFinite();
    if (chain.diverged)
      return;
    Random random(options_.seed, static_cast<std::uint64_t>(index));
    WeightedScore score(mode.model, make_score_(mode.model.estimate));
    score.setShapeGain(mode.plan.shape_gain);
    const StepPlan& steps = mode.plan.steps;
    LangevinChain langevin(steps, gaussian.draw(random), score, random);
    Matrix6Xd& kept = mode.positions[static_cast<std::size_t>(index_in_mode)];
    kept.resize(6, numDraws(mode, index_in_mode));
    Eigen::Index num_kept = 0;
    const long num_steps = numSteps(mode, index_in_mode);
    for (long step = 1; step <= num_steps && !run_.stopped(); ++step) {
      langevin.step();
      chain.diverged = !langevin.position().allFinite();
      if (chain.diverged)
        break;
      const long sampled = step - steps.num_burn_in;
      if (sampled > 0 && sampled % steps.thinning == 0)
        kept.col(num_kept++) = langevin.position();
      run_.reportStep(index, step, [&] {
        return poseOf(mode.model.coordinates.pose(langevin.position()).matrix());
      });
    }
    kept.conservativeResize(6, num_kept);
  }

  const MakeBatchScore& make_score_;
  const ChainOptions& options_;
  RunState run_;
  std::vector<std::unique_ptr<ModeRun>> modes_;
  std::vector<Chain> chains_;
};

MakeBatchScore
scoresOf(const SurfaceScorer& scorer)
{
  return [&](const CalibratedEstimate& estimate) {
    return [&, hints = PatchHints()](const Eigen::Isometry3d& T_target_source,
                                     const std::vector<std::size_t>& indices,
                                     Vector6d& total) mutable {
      return scorer.batchScore(T_target_source,
                               estimate.centre,
                               estimate.residual_scale,
                               indices,
                               hints,
                               total);
    };
  };
}

} // namespace

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
sampleCalibrated(const MakeBatchScore& make_score,
                 const Prior& prior,
                 const CalibratedEstimate& estimate,
                 const ChainOptions& options,
                 const ProgressCallback& progress)
{
  CalibratedRun run(make_score, options, progress);
  run.addMode(estimate, prior, options.num_draws);
  return run.run();
}

ChainSet
sampleCalibrated(const SurfaceScorer& scorer,
                 const Prior& prior,
                 const CalibratedEstimate& estimate,
                 const ChainOptions& options,
                 const ProgressCallback& progress)
{
  return sampleCalibrated(scoresOf(scorer), prior, estimate, options, progress);
}

ChainSet
sampleCalibrated(const SurfaceScorer& scorer,
                 const Prior& prior,
                 const std::vector<CalibratedMode>& modes,
                 const ChainOptions& options,
                 const ProgressCallback& progress)
{
  const MakeBatchScore make_score = scoresOf(scorer);
  CalibratedRun run(make_score, options, progress);
  const std::vector<double> shares = sharesOf(modes);
  std::vector<ChainMode> sampled;
  for (std::size_t m = 0; m < modes.size(); ++m) {
    const auto num_draws = static_cast<int>(std::lround(shares[m] * options.num_draws));
    if (num_draws < options.num_chains)
      continue;
    ChainMode mode;
    for (int i = 0; i < options.num_chains; ++i)
      mode.members.push_back(static_cast<int>(sampled.size()) * options.num_chains + i);
    mode.log_evidence = modes[m].log_weight;
    sampled.push_back(mode);
    run.addMode(modes[m].estimate, prior, num_draws);
  }
  ChainSet result = run.run();
  result.modes = sampled;
  return result;
}

} // namespace bayesian_icp
