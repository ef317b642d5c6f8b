#include "commands.h"
#include "io/cloud_file.h"
#include "io/text_hash.h"
#include "samplers/gold_cache.h"
#include "samplers/result_table.h"
#include "samplers/samplers_options.h"
#include "samplers/score.h"
#include "study/formatted_text.h"

#include <iostream>
#include <limits>
#include <set>
#include <utility>

namespace bayesian_icp::evaluate {

namespace {

/** N / sigma^2 of the paper [1/m^2]. */
constexpr double paper_weight = 6000.0;

std::string
nameWith(const std::string& sampler, double number)
{
  return sampler + format(" %.3g", number);
}

/** The samplers on one problem: runs what is not in the result file yet. */
struct ProblemStudy {
  using Sampler = std::function<SamplerRun(std::uint64_t seed)>;

  /** Make the gold standard or read it, and run what is missing.
   * \return whether the gold standard has converged */
  bool
  run();

  /** One run, from the file if it is there. */
  Score
  runOnce(const std::string& name, std::uint64_t seed, const Sampler& sampler);

  void
  runAllSeeds(const std::string& name, const Sampler& sampler);

  /** At the step sizes that were asked for, and smaller ones as long as they are
   * better; all seeds at the best one. */
  void
  runPaperSteps();

  /** At several step sizes; all seeds at the one of the highest rate. */
  void
  runMalaSteps(const Oracle& oracle);

  void
  report(const std::string& line) const;

  const Problem& problem;
  const SamplersOptions& options;
  ResultFile& results;
  PoseMatrix gold_draws = PoseMatrix();
};

void
ProblemStudy::report(const std::string& line) const
{
  std::cerr << problem.name()
            << format(", sigma %g m, N %g: ",
                      problem.cell().sigma,
                      problem.cell().effective_points)
            << line << std::endl;
}

Score
ProblemStudy::runOnce(const std::string& name,
                      std::uint64_t seed,
                      const Sampler& sampler)
{
  ScoredRun run;
  run.name = {problem.name(),
              problem.cell().sigma,
              problem.cell().effective_points,
              name,
              seed,
              io::textOfHash(goldKey(problem, options.gold))};
  const ScoredRun& kept = results.findOrMake(run.name, [&] {
    const SamplerRun made = sampler(seed);
    run.score = scoreOf(made, gold_draws);
    report(name + ", seed " + std::to_string(seed) +
           format(": KL %.3g, %.3g s, ", run.score.kl, run.score.seconds) +
           run.score.status + ' ' + made.message);
    return run;
  });
  return kept.score;
}

void
ProblemStudy::runAllSeeds(const std::string& name, const Sampler& sampler)
{
  for (int seed = 1; seed <= options.num_seeds; ++seed)
    runOnce(name, static_cast<std::uint64_t>(seed), sampler);
}

void
ProblemStudy::runPaperSteps()
{
  std::set<double> steps;
  for (const double step : options.step_sizes) {
    steps.insert(step);
    steps.insert(step * paper_weight / problem.energy().weight());
  }
  const auto sampler = [this](double step) {
    return [this, step](std::uint64_t seed) {
      return runPaper(problem, seed, options.num_threads, step);
    };
  };
  double best_step = *steps.begin();
  double best_kl = std::numeric_limits<double>::infinity();
  const auto tryStep = [&](double step) {
    const double kl = runOnce(nameWith("paper", step), 1, sampler(step)).kl;
    const bool is_best = kl < best_kl;
    if (is_best) {
      best_kl = kl;
      best_step = step;
    }
    return is_best;
  };
  for (const double step : steps)
    tryStep(step);
  // The range given may end above the best one.
  if (best_step == *steps.begin())
    while (tryStep(0.1 * best_step)) {
    }
  runAllSeeds(nameWith("paper", best_step), sampler(best_step));
}

void
ProblemStudy::runMalaSteps(const Oracle& oracle)
{
  const auto sampler = [&](double step) {
    return [this, &oracle, step](std::uint64_t seed) {
      return runOracleMala(problem, oracle, seed, step);
    };
  };
  double best_step = 0.0, best_rate = -1.0;
  for (const double step : {0.25, 0.5, 1.0}) {
    const double rate =
        runOnce(nameWith("mala", step), 1, sampler(step)).essPerSecond();
    if (rate > best_rate) {
      best_rate = rate;
      best_step = step;
    }
  }
  runAllSeeds(nameWith("mala", best_step), sampler(best_step));
}

bool
ProblemStudy::run()
{
  const GoldStandard gold = cachedGold(
      problem, options.gold, options.cache_folder, [this](const std::string& line) {
        report(line);
      });
  if (!gold.has_converged)
    report("the gold standard has NOT converged");
  gold_draws = pooled(gold.chains);
  const Oracle oracle = oracleOf(problem, gold);
  for (const auto& [name, steps] :
       {std::pair("exact", ExactSteps::Automatic),
        std::pair("exact-metropolis", ExactSteps::Metropolis)})
    if (options.wants(name))
      runAllSeeds(name, [&, of_run = steps](std::uint64_t seed) {
        return runExact(problem, seed, options.num_threads, of_run);
      });
  for (const auto steps : {ExactSteps::SteinGradient, ExactSteps::SteinNewton})
    if (options.wants(toString(steps)))
      for (const int particles : options.particles)
        runAllSeeds(nameWith(toString(steps), particles), [&](std::uint64_t seed) {
          return runExact(problem, seed, options.num_threads, steps, particles);
        });
  if (options.wants("paper"))
    runPaperSteps();
  if (options.wants("walk"))
    runAllSeeds("walk", [&](std::uint64_t seed) {
      return runOracleWalk(problem, oracle, seed);
    });
  if (options.wants("mala"))
    runMalaSteps(oracle);
  return gold.has_converged;
}

} // namespace

int
runSamplersCommand(int argc, const char* const* argv)
{
  const std::optional<SamplersOptions> options = parseSamplersOptions(argc, argv);
  if (!options)
    return 0;
  io::silencePcl();
  ResultFile results(options->result.file);
  bool all_converged = true;
  for (const std::string& name : options->scenes) {
    const Scene scene = readScene(
        options->data_folder, name, static_cast<std::size_t>(options->num_points));
    for (const Cell& cell : options->cells) {
      const Problem problem(scene, cell, options->residual);
      all_converged &= ProblemStudy{problem, *options, results}.run();
    }
  }
  printTable(results.runs(), std::cout);
  const int report_code = options->result.report();
  return all_converged ? report_code : 1;
}

} // namespace bayesian_icp::evaluate
