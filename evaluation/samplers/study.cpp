#include "samplers/study.h"

#include "io/text_hash.h"
#include "samplers/gold_cache.h"

#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

namespace bayesian_icp::evaluate {

namespace {

/** N / sigma^2 of the paper [1/m^2]. */
constexpr double paper_weight = 6000.0;

std::string
nameWith(const std::string& sampler, double number)
{
  std::ostringstream name;
  name.precision(3);
  name << sampler << ' ' << number;
  return name.str();
}

} // namespace

Study::Study(const Problem& problem,
             const SamplersOptions& options,
             ResultFile& results,
             const Report& report)
: problem_(problem)
, options_(options)
, results_(results)
, report_(report)
{}

Score
Study::runOnce(const std::string& name, std::uint64_t seed, const Sampler& sampler)
{
  ScoredRun run;
  run.name = {problem_.name(),
              problem_.cell().sigma,
              problem_.cell().effective_points,
              name,
              seed,
              io::textOfHash(goldKey(problem_, options_.gold))};
  if (const ScoredRun* known = results_.find(run.name))
    return known->score;
  const SamplerRun made = sampler(seed);
  run.score = scoreOf(made, gold_draws_);
  results_.add(run);
  std::ostringstream line;
  line.precision(3);
  line << name << ", seed " << seed << ": KL " << run.score.kl << ", "
       << run.score.seconds << " s, " << run.score.status << ' ' << made.message;
  report_(line.str());
  return run.score;
}

void
Study::runAllSeeds(const std::string& name, const Sampler& sampler)
{
  for (int seed = 1; seed <= options_.num_seeds; ++seed)
    runOnce(name, static_cast<std::uint64_t>(seed), sampler);
}

void
Study::runPaperSteps()
{
  std::set<double> steps;
  for (const double step : options_.step_sizes) {
    steps.insert(step);
    steps.insert(step * paper_weight / problem_.energy().weight());
  }
  const auto sampler = [this](double step) {
    return [this, step](std::uint64_t seed) {
      return runPaper(problem_, seed, options_.num_threads, step);
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
Study::runMalaSteps(const Oracle& oracle)
{
  const auto sampler = [&](double step) {
    return [this, &oracle, step](std::uint64_t seed) {
      return runOracleMala(problem_, oracle, seed, step);
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
Study::run()
{
  const GoldStandard gold =
      cachedGold(problem_, options_.gold, options_.cache_folder, report_);
  if (!gold.has_converged)
    report_("the gold standard has NOT converged");
  gold_draws_ = pooled(gold.chains);
  const Oracle oracle = oracleOf(problem_, gold);
  for (const auto& [name, steps] :
       {std::pair("exact", ExactSteps::Automatic),
        std::pair("exact-metropolis", ExactSteps::Metropolis)})
    if (options_.wants(name))
      runAllSeeds(name, [&, of_run = steps](std::uint64_t seed) {
        return runExact(problem_, seed, options_.num_threads, of_run);
      });
  for (const auto steps : {ExactSteps::SteinGradient, ExactSteps::SteinNewton})
    if (options_.wants(toString(steps)))
      for (const int particles : options_.particles)
        runAllSeeds(nameWith(toString(steps), particles), [&](std::uint64_t seed) {
          return runExact(problem_, seed, options_.num_threads, steps, particles);
        });
  if (options_.wants("paper"))
    runPaperSteps();
  if (options_.wants("walk"))
    runAllSeeds("walk", [&](std::uint64_t seed) {
      return runOracleWalk(problem_, oracle, seed);
    });
  if (options_.wants("mala"))
    runMalaSteps(oracle);
  return gold.has_converged;
}

} // namespace bayesian_icp::evaluate
