#include "paper/paper.h"

#include "paper/matched_batch.h"
#include "sampler/sampling.h"

namespace bayesian_icp {

namespace {

/** Algorithm 1 for one chain: SgldChain::step() is its loop's body. */
Chain
runChain(const Vector6d& guess,
         const SampledDensity& density,
         const PaperOptions& options,
         const ChainOptions& chains,
         int chain_index,
         RunState& run)
{
  Random random(chains.seed, static_cast<std::uint64_t>(chain_index));
  const Schedule schedule = {
      options.num_burn_in, options.thinning, chains.numDrawsOf(chain_index)};
  Vector6d start = guess;
  if (!options.initial_spread.isZero(0.0))
    start += options.initial_spread.cwiseProduct(random.normal6());
  SgldChain sgld_chain(options.sgld,
                       schedule.numSteps(),
                       start,
                       density.make_gradient(chain_index),
                       density.has_diverged,
                       random);
  const auto to_pose = [](const Vector6d& pose) { return pose; };
  Path path;
  advance(sgld_chain, schedule, to_pose, chain_index, run, path);
  path.has_diverged = path.has_diverged || sgld_chain.isWhiteNoise();
  return chainOf(path, to_pose);
}

} // namespace

ChainSet
runChains(const Vector6d& start,
          const SampledDensity& density,
          const PaperOptions& options,
          const ChainOptions& chains,
          const ProgressCallback& progress)
{
  ChainSet result;
  result.chains.resize(static_cast<std::size_t>(chains.num_chains));
  RunState run(progress, numStepsOf(chains, options.num_burn_in, options.thinning));
  forEachChain(chains.num_chains,
               density.is_thread_safe ? chains.num_threads : 1,
               run,
               [&](int i) {
                 result.chains[static_cast<std::size_t>(i)] =
                     runChain(start, density, options, chains, i, run);
               });
  result.cancelled = run.cancelled();
  return result;
}

MiniBatchGradient
posteriorGradient(const Eigen::Matrix3Xd& source_points,
                  const CorrespondenceSearch& search,
                  const Prior& prior,
                  double weight,
                  const MiniBatches& mini_batches)
{
  return [batch = MatchedBatch(source_points, search, mini_batches), &prior, weight](
             const Vector6d& pose, Random& random) mutable {
    batch.draw(pose, random);
    const Vector6d mean = batch.meanGradient();
    return EnergyGradient{weight * mean + prior.energyGradient(pose), mean};
  };
}

ChainSet
samplePaper(const Eigen::Matrix3Xd& source_points,
            const CorrespondenceSearch& search,
            const Prior& prior,
            const Vector6d& initial_pose,
            const PaperOptions& options,
            const ChainOptions& chains,
            const RunsAway& has_diverged,
            const ProgressCallback& progress)
{
  const MiniBatches mini_batches(static_cast<std::size_t>(source_points.cols()),
                                 static_cast<std::size_t>(options.batch_size),
                                 options.sampling);
  SampledDensity density;
  density.make_gradient = [&](int) {
    return posteriorGradient(
        source_points, search, prior, options.scale.weight(), mini_batches);
  };
  density.has_diverged = has_diverged;
  density.is_thread_safe = search.isThreadSafe();
  return runChains(initial_pose, density, options, chains, progress);
}

} // namespace bayesian_icp
