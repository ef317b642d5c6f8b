#include "baselines/monte_carlo_icp.h"

#include "geometry/twist.h"
#include "threads/for_each_piece.h"

#include <bayesian_icp/random.h>

#include <algorithm>
#include <limits>

namespace bayesian_icp {

namespace {

Vector6d
drawStart(const MonteCarloIcpOptions& options, int index)
{
  Random random(options.seed, static_cast<std::uint64_t>(index));
  Vector6d start;
  for (int k = 0; k < 6; ++k)
    start[k] = options.mean[k] + options.half_range[k] * (2.0 * random.uniform() - 1.0);
  return start;
}

MonteCarloIcpRun
makeRun(const MonteCarloIcpOptions& options, int index, IcpRunner& icp)
{
  MonteCarloIcpRun run;
  run.index = index;
  run.start = drawStart(options, index);
  const IcpResult result = icp.run(isometryOf(run.start), options.icp);
  run.end = poseOf(result.T_target_source.matrix());
  run.has_converged = result.has_converged;
  run.stop = result.stop;
  run.num_iterations = result.num_iterations;
  run.mean_squared_distance = result.mean_squared_distance;
  return run;
}

} // namespace

std::vector<MonteCarloIcpRun>
monteCarloIcp(const Eigen::Matrix3Xd& source,
              const KdTree& target,
              const MonteCarloIcpOptions& options)
{
  const int max_runs = std::numeric_limits<int>::max() - std::max(0, options.first_run);
  const int num_runs = std::clamp(options.num_runs, 0, max_runs);
  const int num_threads = numThreadsFor(options.num_threads, num_runs);
  std::vector<IcpRunner> icp(static_cast<std::size_t>(num_threads),
                             IcpRunner(source, target));
  std::vector<MonteCarloIcpRun> runs(static_cast<std::size_t>(num_runs));
  forEachPiece(num_runs, num_threads, [&](int i) {
    const auto thread = static_cast<std::size_t>(omp_get_thread_num());
    runs[static_cast<std::size_t>(i)] =
        makeRun(options, options.first_run + i, icp[thread]);
  });
  return runs;
}

} // namespace bayesian_icp
