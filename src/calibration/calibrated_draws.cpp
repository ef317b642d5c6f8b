#include "../run_state.h"
#include "draw_plan.h"
#include "weighted_score.h"

#include <bayesian_icp/langevin.h>

#include <limits>

namespace bayesian_icp {

namespace {

/** Of the plan's random numbers; chains have streams 0, 1, ... */
constexpr std::uint64_t plan_stream = std::numeric_limits<std::uint64_t>::max();

/** One run. */
class CalibratedRun {
public:
  CalibratedRun(const MakeBatchScore& make_score,
                const Prior& prior,
                const CalibratedEstimate& estimate,
                const ChainOptions& options,
                const ProgressCallback& progress)
  : make_score_(make_score)
  , model_(estimate, prior)
  , options_(options)
  , run_(progress)
  , positions_(static_cast<std::size_t>(options.num_chains))
  {}

  ChainSet
  run()
  {
    ChainSet result;
    result.chains.resize(positions_.size());
    if (model_.coordinates.gaussian().factor().allFinite())
      sample(result);
    else
      for (Chain& chain : result.chains)
        chain.diverged = true;
    spreadAsEstimated(model_.coordinates, positions_);
    for (std::size_t i = 0; i < positions_.size(); ++i)
      result.chains[i].draws = posesOf(model_.coordinates, positions_[i]);
    result.cancelled = run_.cancelled();
    return result;
  }

private:
  void
  sample(ChainSet& result)
  {
    Random random(options_.seed, plan_stream);
    WeightedScore score(model_, make_score_());
    const DrawPlan plan = planDraws(score, model_, options_, random);
    long total_steps = 0;
    for (int i = 0; i < options_.num_chains; ++i)
      total_steps += numSteps(plan, i);
    run_.addSteps(total_steps);
    forEachChain(options_.num_chains, numThreadsFor(options_, true), run_, [&](int i) {
      sampleChain(plan, i, result.chains[static_cast<std::size_t>(i)]);
    });
  }

  long
  numSteps(const DrawPlan& plan, int chain) const
  {
    return plan.steps.num_burn_in +
           static_cast<long>(plan.steps.thinning) * options_.numDrawsOf(chain);
  }

  void
  sampleChain(const DrawPlan& plan, int chain_index, Chain& chain)
  {
    Random random(options_.seed, static_cast<std::uint64_t>(chain_index));
    WeightedScore score(model_, make_score_());
    score.setShapeGain(plan.shape_gain);
    LangevinChain langevin(
        plan.steps, model_.coordinates.gaussian().draw(random), score, random);
    Matrix6Xd& kept = positions_[static_cast<std::size_t>(chain_index)];
    kept.resize(6, options_.numDrawsOf(chain_index));
    Eigen::Index num_kept = 0;
    const long num_steps = numSteps(plan, chain_index);
    for (long step = 1; step <= num_steps && !run_.stopped(); ++step) {
      langevin.step();
      chain.diverged = !langevin.position().allFinite();
      if (chain.diverged)
        break;
      const long sampled = step - plan.steps.num_burn_in;
      if (sampled > 0 && sampled % plan.steps.thinning == 0)
        kept.col(num_kept++) = langevin.position();
      run_.reportStep(chain_index, step);
    }
    kept.conservativeResize(6, num_kept);
  }

  const MakeBatchScore& make_score_;
  WeightedScoreModel model_;
  const ChainOptions& options_;
  RunState run_;
  /** Draws of each chain, one a column. */
  std::vector<Matrix6Xd> positions_;
};

} // namespace

ChainSet
sampleCalibrated(const MakeBatchScore& make_score,
                 const Prior& prior,
                 const CalibratedEstimate& estimate,
                 const ChainOptions& options,
                 const ProgressCallback& progress)
{
  return CalibratedRun(make_score, prior, estimate, options, progress).run();
}

ChainSet
sampleCalibrated(const SurfaceScorer& scorer,
                 const Prior& prior,
                 const CalibratedEstimate& estimate,
                 const ChainOptions& options,
                 const ProgressCallback& progress)
{
  const MakeBatchScore make_score = [&] {
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
  return sampleCalibrated(make_score, prior, estimate, options, progress);
}

} // namespace bayesian_icp
