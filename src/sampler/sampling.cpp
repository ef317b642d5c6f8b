#include "sampler/sampling.h"

namespace bayesian_icp {

using Eigen::Index;

long
numStepsOf(const ChainOptions& chains, int num_burn_in, int thinning)
{
  long num_steps = 0;
  for (int i = 0; i < chains.num_chains; ++i)
    num_steps += Schedule{num_burn_in, thinning, chains.numDrawsOf(i)}.numSteps();
  return num_steps;
}

void
advance(SamplingChain& sampler,
        const Schedule& schedule,
        const ToPose& to_pose,
        int chain,
        RunState& run,
        Path& path)
{
  Index num_kept = path.positions.cols();
  const long num_steps = schedule.numSteps(num_kept);
  path.positions.conservativeResize(6, schedule.num_draws);
  for (long step = 1; step <= num_steps && !run.stopped(); ++step) {
    sampler.step();
    path.has_diverged = sampler.hasDiverged();
    if (path.has_diverged)
      break;
    const long sampled = step - schedule.num_burn_in;
    if (sampled > 0 && sampled % schedule.thinning == 0)
      path.positions.col(num_kept++) = sampler.position();
    run.reportStep(
        chain, ++path.num_steps, [&] { return to_pose(sampler.position()); });
  }
  path.positions.conservativeResize(6, num_kept);
}

Chain
chainOf(const Path& path, const ToPose& to_pose)
{
  Chain chain;
  chain.diverged = path.has_diverged;
  chain.draws.resize(path.positions.cols(), 6);
  for (Index i = 0; i < path.positions.cols(); ++i)
    chain.draws.row(i) = canonicalPose(to_pose(path.positions.col(i))).transpose();
  return chain;
}

} // namespace bayesian_icp
