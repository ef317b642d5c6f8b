#include "run_state.h"

#include <bayesian_icp/chains.h>

namespace bayesian_icp {

namespace {

long
numStepsOf(const ChainOptions& options, int chain)
{
  return options.num_burn_in +
         static_cast<long>(options.thinning) * options.numDrawsOf(chain);
}

/** Whether an angle moves by more than half a turn in one step. A chain that does so
 * most of the time is white noise on the circle, whose R-hat and effective sample size
 * are perfect, and no walk through the posterior. */
bool
jumpsByHalfATurn(const Vector6d& pose, const Vector6d& next)
{
  constexpr double half_a_turn = 3.14159265358979323846;
  return (next - pose).tail<3>().cwiseAbs().maxCoeff() > half_a_turn;
}

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
  const long num_steps = numStepsOf(options, chain_index);
  Vector6d start = guess;
  if (!options.initial_spread.isZero(0.0))
    start += options.initial_spread.cwiseProduct(random.normal6());
  SgldChain sgld_chain(
      sgld, num_steps, start, target.make_gradient(chain_index), random);

  Chain chain;
  chain.draws.resize(options.numDrawsOf(chain_index), 6);
  long num_kept = 0, num_jumps = 0;
  for (long step = 1; step <= num_steps && !run.stopped(); ++step) {
    const Vector6d last_pose = sgld_chain.position();
    sgld_chain.step();
    const Vector6d& pose = sgld_chain.position();
    num_jumps += jumpsByHalfATurn(last_pose, pose);
    chain.diverged = !pose.allFinite() || target.has_diverged(pose);
    if (chain.diverged)
      break;
    const long sampled = step - options.num_burn_in;
    if (sampled > 0 && sampled % options.thinning == 0)
      chain.draws.row(num_kept++) = canonicalPose(pose).transpose();
    run.reportStep(chain_index, step, [&pose] { return pose; });
  }
  chain.diverged = chain.diverged || 2 * num_jumps > num_steps;
  chain.draws.conservativeResize(num_kept, 6);
  return chain;
}

} // namespace

ChainSet
runChains(const Vector6d& start,
          const SamplerTarget& target,
          const SgldOptions& sgld,
          const ChainOptions& options,
          const ProgressCallback& progress)
{
  long total_steps = 0;
  for (int i = 0; i < options.num_chains; ++i)
    total_steps += numStepsOf(options, i);

  ChainSet result;
  result.chains.resize(static_cast<std::size_t>(options.num_chains));
  RunState run(progress, total_steps);
  forEachChain(options.num_chains,
               numThreadsFor(options, target.is_thread_safe),
               run,
               [&](int i) {
                 result.chains[static_cast<std::size_t>(i)] =
                     runChain(start, target, sgld, options, i, run);
               });
  result.cancelled = run.cancelled();
  return result;
}

} // namespace bayesian_icp
