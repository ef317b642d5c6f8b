#include "samplers/sampler_runs.h"

#include "io/clocks.h"
#include "study/draw_statistics.h"

#include <bayesian_icp/pipeline.h>

#include <cmath>

namespace bayesian_icp::evaluate {

namespace {

constexpr int num_chains = 4;
/** Steps of each chain of a competitor: enough to see its rate, not to converge. */
constexpr int num_competitor_steps = 1500;

template <typename RunChain>
SamplerRun
runCompetitor(const Problem& problem,
              const Oracle& oracle,
              std::uint64_t seed,
              const RunChain& run_chain)
{
  const double begin = io::cpuSeconds();
  SamplerRun run;
  for (int i = 0; i < num_chains; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    const auto start = static_cast<Eigen::Index>(
        random.index(static_cast<std::size_t>(oracle.starts.rows())));
    Chain chain;
    chain.draws = run_chain(Vector6d(oracle.starts.row(start).transpose()), random);
    for (Eigen::Index row = 0; row < chain.draws.rows(); ++row)
      chain.draws.row(row) =
          canonicalPose(problem.energy().toTheta(chain.draws.row(row).transpose()))
              .transpose();
    run.chains.chains.push_back(std::move(chain));
  }
  run.seconds = io::cpuSeconds() - begin;
  return run;
}

} // namespace

SamplerRun
runPreset(const Eigen::Matrix3Xd& source,
          const KdTree& target,
          const Options& options,
          const Vector6d& start)
{
  const double begin = io::cpuSeconds();
  PosteriorEstimate estimate = estimatePosterior(source, target, start, options);
  SamplerRun run;
  run.seconds = io::cpuSeconds() - begin;
  run.chains.chains = std::move(estimate.chains);
  run.status = toString(estimate.summary.status);
  run.message = estimate.summary.message;
  run.summary = std::move(estimate.summary);
  return run;
}

Oracle
oracleOf(const Problem& problem, const GoldStandard& gold)
{
  Oracle oracle;
  oracle.starts = pooled(gold.chains);
  for (Eigen::Index row = 0; row < oracle.starts.rows(); ++row)
    oracle.starts.row(row) =
        problem.energy().toPhi(oracle.starts.row(row).transpose()).transpose();
  oracle.factor = momentsOf(oracle.starts).covariance.llt().matrixL();
  return oracle;
}

SamplerRun
runExact(const Problem& problem,
         std::uint64_t seed,
         int num_threads,
         ExactSteps steps,
         int num_particles)
{
  Options options = problem.options(Preset::Exact);
  options.exact.steps = steps;
  options.exact.num_particles = num_particles;
  options.chains.seed = seed;
  options.chains.num_threads = num_threads;
  return runPreset(problem.scene().source, problem.scene().target, options);
}

SamplerRun
runPaper(const Problem& problem, std::uint64_t seed, int num_threads, double step_size)
{
  Options options = problem.options(Preset::Paper);
  options.paper.sgld.step_size = step_size;
  options.paper.num_burn_in = 1000;
  options.paper.thinning = 10;
  options.chains.seed = seed;
  options.chains.num_threads = num_threads;
  return runPreset(problem.scene().source, problem.scene().target, options);
}

SamplerRun
runOracleWalk(const Problem& problem, const Oracle& oracle, std::uint64_t seed)
{
  const EnergyFunction energy = problem.goldTarget().make_energy();
  const Matrix6d factor = 2.38 / std::sqrt(6.0) * oracle.factor;
  return runCompetitor(
      problem, oracle, seed, [&](const Vector6d& start, Random& random) {
        return runRandomWalk(start, energy, factor, num_competitor_steps, random);
      });
}

SamplerRun
runOracleMala(const Problem& problem,
              const Oracle& oracle,
              std::uint64_t seed,
              double step)
{
  const GradientFunction energy = problem.makeGradient();
  return runCompetitor(
      problem, oracle, seed, [&](const Vector6d& start, Random& random) {
        return runMala(
            start, energy, oracle.factor, step, num_competitor_steps, random);
      });
}

} // namespace bayesian_icp::evaluate
