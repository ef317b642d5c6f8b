#include "sampler/sampling.h"

#include <bayesian_icp/chains.h>

namespace bayesian_icp {

namespace {

/** Algorithm 1 for one chain. */
Chain
runChain(const Vector6d& guess,
         const SamplerTarget& target,
         const SgldOptions& sgld,
         const ChainOptions& options,
         int chain_index,
         RunState& run)
{
  Random random(options.seed, static_cast<std::uint64_t>(chain_index));
  const Schedule schedule = scheduleOf(options, chain_index);
  Vector6d start = guess;
  if (!options.initial_spread.isZero(0.0))
    start += options.initial_spread.cwiseProduct(random.normal6());
  SgldChain sgld_chain(sgld,
                       schedule.numSteps(),
                       start,
                       target.make_gradient(chain_index),
                       target.has_diverged,
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
          const SamplerTarget& target,
          const SgldOptions& sgld,
          const ChainOptions& options,
          const ProgressCallback& progress)
{
  ChainSet result;
  result.chains.resize(static_cast<std::size_t>(options.num_chains));
  RunState run(progress, numStepsOf(options));
  forEachChain(options.num_chains,
               target.is_thread_safe ? options.num_threads : 1,
               run,
               [&](int i) {
                 result.chains[static_cast<std::size_t>(i)] =
                     runChain(start, target, sgld, options, i, run);
               });
  result.cancelled = run.cancelled();
  return result;
}

} // namespace bayesian_icp
