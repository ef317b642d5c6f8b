#include "commands.h"
#include "io/cloud_file.h"
#include "io/folders.h"
#include "io/numbers.h"
#include "register/choices.h"
#include "samplers/sampler_problem.h"
#include "samplers/score.h"
#include "study/option_values.h"
#include "study/text_table.h"

#include <boost/algorithm/string/join.hpp>
#include <boost/range/algorithm_ext/erase.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace bayesian_icp::evaluate {

namespace po = boost::program_options;

namespace {

/** What is compared, and where it is kept. */
struct SamplersOptions {
  std::string data_folder = "data";
  ResultOptions result = {"results/samplers.csv"};
  bool is_quick = false;
  std::vector<std::string> scenes = {"can", "bowl", "mug", "table", "corridor"};
  std::vector<Cell> cells;
  std::vector<std::string> samplers = {"exact",
                                       "exact-metropolis",
                                       "stein-gradient",
                                       "stein-newton",
                                       "paper",
                                       "walk",
                                       "mala"};
  Residual residual = Residual::PointToPoint;
  /** Numbers of particles that Stein samplers are tried with. */
  std::vector<int> particles;
  int num_seeds = 5;
  int num_points = 2000;
  int num_threads = 1;
  GoldOptions gold;

  /** Whether a sampler was asked for. */
  bool
  wants(const std::string& sampler) const
  {
    return std::count(samplers.begin(), samplers.end(), sampler) > 0;
  }
};

constexpr int max_threads = 64;
constexpr double unlimited = std::numeric_limits<double>::infinity();

double
positiveNumberOf(std::string_view text)
{
  double number = 0.0;
  if (!io::readNumber(text, number) || !(number > 0.0) || !std::isfinite(number))
    io::refuseValue(std::string(text), "a positive number");
  return number;
}

Cell
cellOf(const std::string& text)
{
  const auto numbers = io::splitAt(':', text);
  if (numbers.size() != 2)
    io::refuseValue(text, "of the form sigma:N");
  return {positiveNumberOf(numbers[0]), positiveNumberOf(numbers[1])};
}

/** An option with several values, separated by commas, each of which \p read reads. */
template <typename Value>
po::typed_value<std::string>*
listOf(const std::string& standard,
       std::vector<Value>& values,
       Value (*read)(const std::string&))
{
  return taken(standard, [&values, read](const std::string& text) {
    values.clear();
    for (const std::string& word : wordsOf(text))
      values.push_back(read(word));
  });
}

/** A sampler of the default ones. */
std::string
samplerOf(const std::string& name)
{
  requireKnown({name}, SamplersOptions().samplers);
  return name;
}

int
numParticlesOf(const std::string& text)
{
  int number = 0;
  io::readValue(text, number);
  requireWithin(number, min_particles, 10000);
  return number;
}

constexpr char samplers_help[] = R"(Usage: pcl_bayesian_icp_evaluate samplers [options]

Compares the draws of every sampler with a gold standard: long Metropolis
runs on the same posterior, kept with the results. Each run is a row of a
CSV file: KL divergence of Gaussian moments (gold standard to sampler,
6-D and per coordinate) [nats], Wasserstein-1 distance [standard deviations
of the gold standard] and Kolmogorov-Smirnov distance of the marginals,
largest R-hat, smallest bulk and tail effective sample size (ESS), CPU time
of all threads [s], smallest bulk ESS per second, status. A summary of medians
and worst cases goes to standard output, progress to standard error. Delete
results of another build of the samplers by hand.
Exit codes: 0 success, 1 a gold standard did not converge, 2 usage, 3 a file
cannot be read or written, or the report cannot be made.
)";

po::options_description
describeOptions(SamplersOptions& options)
{
  po::options_description description("Options", 88);
  // clang-format off
  description.add_options()
    ("data", text(options.data_folder),
     "folder with one folder for each scene: source.pcd, target.pcd [m]")
    ("scenes", list(options.scenes), "names of scenes, separated by commas")
    ("cells", listOf("1:6000,0.0015:100,0.0015:1000,0.005:300", options.cells, cellOf),
     "scales of the likelihood as sigma:N, separated by commas: sigma [m], effective "
     "points N")
    ("residual", taken("point-to-point", [&options](const std::string& text) {
       if (!app::readChoice(text, options.residual))
         io::refuseValue(text, app::namesOfChoices(Residual()));
     }),
     ("residual of the energy, for all samplers and the gold standard (paper has its "
      "own): " + app::namesOfChoices(Residual())).c_str())
    ("samplers", listOf(boost::algorithm::join(options.samplers, ","), options.samplers,
                        samplerOf),
     "samplers to compare: exact (preset exact), exact-metropolis (the same with "
     "Metropolis steps), stein-gradient and stein-newton (with Stein steps), paper "
     "(Algorithm 1 at several step sizes; all seeds at the best one), walk and mala "
     "(full batch; covariance and starts from the gold standard)")
    ("particles", listOf("20,50,100", options.particles, numParticlesOf),
     "numbers of particles of the Stein samplers")
    ("seeds", integer(options.num_seeds, 1, 1000),
     "number of runs of each sampler, with seeds 1, 2, ...")
    ("points", integer(options.num_points, 10, 100000000),
     "number of source points, the same for all samplers and the gold standard")
    ("threads", integer(options.num_threads, 1, max_threads),
     "number of threads of the gold standard and the presets")
    ("gold-seconds", positiveNumber(options.gold.max_seconds, unlimited),
     "CPU time after which a gold standard ends, even if it has not converged [s]")
    ("quick", io::flag(options.is_quick),
     "one scene (can), two seeds and 500 points, unless given");
  // clang-format on
  addResultOptions(options.result, description);
  return description;
}

/** \throws io::UsageError with a message for the user */
SamplersOptions
readSamplersOptions(int argc, const char* const* argv)
{
  SamplersOptions options;
  const auto given = readOptions(argc, argv, describeOptions(options), samplers_help);
  if (options.scenes.empty())
    throw io::UsageError("--scenes names no scene");
  if (options.is_quick) {
    if (given["scenes"].defaulted())
      options.scenes = {"can"};
    if (given["seeds"].defaulted())
      options.num_seeds = 2;
    if (given["points"].defaulted())
      options.num_points = 500;
  }
  options.gold.num_threads = options.num_threads;
  return options;
}

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

  void
  report(const std::string& line) const
  {
    std::cerr << problem.name()
              << format(", sigma %g m, N %g: ",
                        problem.cell().sigma,
                        problem.cell().effective_points)
              << line << std::endl;
  }

  /** One run, from the file if it is there. */
  Score
  runOnce(const std::string& name, std::uint64_t seed, const Sampler& sampler)
  {
    ScoredRun run;
    run.name = {problem.name(),
                problem.cell().sigma,
                problem.cell().effective_points,
                name,
                seed,
                gold_key};
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
  runAllSeeds(const std::string& name, const Sampler& sampler)
  {
    for (int seed = 1; seed <= options.num_seeds; ++seed)
      runOnce(name, static_cast<std::uint64_t>(seed), sampler);
  }

  /** At these step sizes, and smaller ones as long as they are better; all seeds at the
   * best one.
   * \param[in] sampler of a step size
   * \param[in] quality of a run; larger is better */
  void
  runSteps(const std::string& name,
           const std::set<double>& steps,
           const std::function<Sampler(double step)>& sampler,
           const std::function<double(const Score& score)>& quality)
  {
    double best_step = *steps.begin();
    double best = -std::numeric_limits<double>::infinity();
    const auto tryStep = [&](double step) {
      const double of_step = quality(runOnce(nameWith(name, step), 1, sampler(step)));
      const bool is_best = of_step > best;
      if (is_best) {
        best = of_step;
        best_step = step;
      }
      return is_best;
    };
    for (const double step : steps)
      tryStep(step);
    if (best_step == *steps.begin())
      while (tryStep(0.1 * best_step)) {
      }
    runAllSeeds(nameWith(name, best_step), sampler(best_step));
  }

  void
  runPaperSteps()
  {
    std::set<double> steps;
    for (const double step : {1e-3, 1e-4, 1e-5, 1e-6}) {
      steps.insert(step);
      steps.insert(step * paper_weight / problem.energy().weight());
    }
    const auto sampler = [this](double step) {
      return [this, step](std::uint64_t seed) {
        return runPaper(problem, seed, options.num_threads, step);
      };
    };
    runSteps("paper", steps, sampler, [](const Score& score) { return -score.kl; });
  }

  void
  runMalaSteps(const Oracle& oracle)
  {
    const auto sampler = [&](double step) {
      return [this, &oracle, step](std::uint64_t seed) {
        return runOracleMala(problem, oracle, seed, step);
      };
    };
    runSteps("mala", {0.25, 0.5, 1.0}, sampler, &Score::essPerSecond);
  }

  /** Make the gold standard or read it, and run what is missing.
   * \return whether the gold standard has converged */
  bool
  run()
  {
    const GoldStandard gold =
        cachedGold(problem,
                   options.gold,
                   io::folderOf(options.result.file),
                   [this](const std::string& line) { report(line); });
    if (!gold.has_converged)
      report("the gold standard has NOT converged");
    gold_draws = pooled(gold.chains);
    gold_key = rowKey(problem, options.gold, gold);
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

  const Problem& problem;
  const SamplersOptions& options;
  ResultFile& results;
  PoseMatrix gold_draws = PoseMatrix();
  std::string gold_key = std::string();
};

} // namespace

int
runSamplersCommand(int argc, const char* const* argv)
{
  const SamplersOptions options = readSamplersOptions(argc, argv);
  io::silencePcl();
  std::vector<Scene> scenes;
  for (const std::string& name : options.scenes)
    scenes.push_back(readScene(
        options.data_folder, name, static_cast<std::size_t>(options.num_points)));
  ResultFile results(options.result.file);
  bool all_converged = true;
  std::set<std::string> keys;
  for (const Scene& scene : scenes)
    for (const Cell& cell : options.cells) {
      const Problem problem(scene, cell, options.residual);
      ProblemStudy study{problem, options, results};
      all_converged &= study.run();
      keys.insert(study.gold_key);
    }
  std::vector<ScoredRun> runs = results.runs();
  boost::range::remove_erase_if(runs, [&keys](const ScoredRun& run) {
    return keys.count(run.name.gold_key) == 0;
  });
  std::cout << summaryOf(runs);
  const int report_code = options.result.report();
  return all_converged ? report_code : 1;
}

} // namespace bayesian_icp::evaluate
