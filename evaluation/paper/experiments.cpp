#include "io/clocks.h"
#include "io/text_hash.h"
#include "paper/paper_experiment.h"
#include "paper/paper_methods.h"
#include "paper/paper_runs.h"
#include "study/text_table.h"

#include <algorithm>
#include <cmath>
#include <iostream>

namespace bayesian_icp::evaluate {

namespace {

/** The runs of an experiment: those of its file, and what is made of them. */
template <typename Run>
class ExperimentRuns {
public:
  /** \param[in] name of the CSV file, without .csv
   * \param[in] title of the table of medians, and its columns */
  ExperimentRuns(const PaperStudy& study,
                 const std::string& name,
                 const std::string& title,
                 const std::vector<SummaryColumn>& columns)
  : study_(study)
  , name_(name)
  , title_(title)
  , columns_(columns)
  , file_(study.path(name + ".csv"))
  {}

  /** Note a pair, and the key of its runs. */
  void
  addPair(const ScanPair& pair, const std::string& key)
  {
    keys_.push_back({pair.name, key});
  }

  /** The run of this name; one that the file does not have is made. */
  template <typename Make>
  const Run&
  find(const PaperRunName& name, const Make& make)
  {
    return file_.findOrMake(name, [&] {
      ++num_made_;
      return make();
    });
  }

  /** Tell how many runs of what were made since the last time. */
  void
  reportMade(const std::string& what)
  {
    if (num_made_ > 0)
      study_.report(what + ", " + std::to_string(num_made_) + " runs");
    num_made_ = 0;
  }

  /** Write the study's record, and print the medians.
   * \param[in] num_starts as in recordExperiment() */
  void
  finish(int num_starts = 0) const
  {
    recordExperiment(study_, name_, keys_, num_starts);
    std::cout << title_ << '\n'
              << summaryText("medians of the runs of", columns_, numbers);
  }

  /** Of all runs, for the medians. */
  std::vector<GroupedNumbers> numbers;

private:
  const PaperStudy& study_;
  std::string name_, title_;
  std::vector<SummaryColumn> columns_;
  RunFile<Run> file_;
  std::vector<PairKey> keys_;
  int num_made_ = 0;
};

DrawPlan
planOf(const PaperStudy& study, std::uint64_t seed)
{
  DrawPlan plan;
  plan.seed = seed;
  plan.num_threads = study.options.num_threads;
  return plan;
}

/** The paper shows these two. */
const std::vector<std::string> shown_objects = {"bowl", "can"};

/** Draws that are taken after burn-in. */
constexpr int num_kept_draws = 2000;

/** Root of the prior's variance: starts as far out as the prior allows. */
constexpr double far_spread = 0.35;

/** Draws of a run. */
constexpr int num_curve_draws = 6000;

/** What is drawn from, once per seed. */
struct CurveVariant {
  /** In the file. */
  std::string name;
  std::string method;
  /** See DrawPlan. */
  double initial_spread = 0.0;
};

/** A curve: the values on its axis, and the part of a run that each means. */
struct CurvePlan {
  /** Of the file. */
  std::string name;
  std::vector<CurveVariant> variants;
  std::vector<int> values;
  DrawPart (*part)(int value);
};

const CurvePlan samples_plan = {
    "samples",
    {{"bayesian-icp", "bayesian-icp"},
     {"exact", "exact"},
     {"calibrated", "calibrated"}},
    {100, 200, 500, 1000, 1500, 2000, 2500, 3000, 4000, 5000, 6000},
    [](int value) {
      return DrawPart{0, value};
    }};

const CurvePlan burn_in_plan = {
    "burn_in",
    {{"near", "bayesian-icp"}, {"far", "bayesian-icp", far_spread}},
    {0, 100, 200, 500, 1000, 1500, 2000, 3000, 4000},
    [](int value) {
      return DrawPart{value, num_kept_draws};
    }};

/** The pairs asked for, or of the six objects those that the paper shows. */
std::vector<ScanPair>
curvePairs(const PaperStudy& study)
{
  std::vector<ScanPair> pairs;
  for (const ScanPair& pair : study.pairs)
    if (std::count(shown_objects.begin(), shown_objects.end(), pair.name) > 0)
      pairs.push_back(pair);
  return pairs.empty() || !study.options.pairs.empty() ? study.pairs : pairs;
}

/** The curve of a variant on a pair; points that are missing are made. */
void
studyVariant(const PaperStudy& study,
             const CurvePlan& plan,
             const CurveVariant& variant,
             const ComparedPair& compared,
             ExperimentRuns<CurvePoint>& runs)
{
  const PaperProblem& problem = compared.problem;
  for (const std::uint64_t seed : study.options.seeds()) {
    DrawPlan draws = planOf(study, seed);
    draws.num_draws = num_curve_draws;
    draws.initial_spread = variant.initial_spread;
    ChainSet chains; // made for the first point that is missing
    for (const int value : plan.values) {
      const PaperRunName name{
          compared.key, problem.pair.name, variant.name, seed, value};
      const CurvePoint& point = runs.find(name, [&] {
        if (chains.chains.empty())
          chains = paperMethod(variant.method).run(problem, draws).chains;
        return CurvePoint{
            name,
            curveDivergences(partOf(chains, plan.part(value)), compared.baseline)};
      });
      runs.numbers.push_back(
          {problem.pair.name + ", " + variant.name + ", " + std::to_string(value),
           {point.divergences.begin(), point.divergences.end()}});
    }
  }
  study.report(problem.pair.name + ": " + plan.name + ", " + variant.name);
}

/** What both experiments are, but for their plan. */
void
runCurves(const PaperStudy& study, const CurvePlan& plan)
{
  ExperimentRuns<CurvePoint> runs(
      study,
      plan.name,
      plan.name + ": KL(baseline || method) [nats]",
      {{"x"}, {"y"}, {"z"}, {"roll"}, {"pitch"}, {"yaw"}, {"6-D"}});
  for (const ScanPair& pair : curvePairs(study)) {
    const ComparedPair compared(study, pair);
    runs.addPair(pair, compared.key);
    for (const CurveVariant& variant : plan.variants)
      studyVariant(study, plan, variant, compared, runs);
  }
  runs.finish();
}

Vector6d
startOf(const PaperRunName& name)
{
  Random random(name.seed, static_cast<std::uint64_t>(name.number));
  Vector6d start;
  for (int k = 0; k < 6; ++k)
    start[k] = (k < 3 ? accuracy_translation_range : accuracy_rotation_range) *
               (2.0 * random.uniform() - 1.0);
  return start;
}

AccuracyRun
accuracyRunOf(const PaperStudy& study,
              const PaperProblem& problem,
              const AccuracyMethod& method,
              const PaperRunName& name)
{
  DrawPlan plan = planOf(study, name.seed + static_cast<std::uint64_t>(name.number));
  plan.start = startOf(name);
  const AccuracyEstimate estimate = method.run(problem, plan);
  const Vector6d error = estimate.pose - poseOf(problem.pair.truth.matrix());
  AccuracyRun run{name, error.head<3>().norm(), 0.0, estimate.status};
  for (int k = 3; k < 6; ++k)
    run.rotation_error += std::abs(wrapAngle(error[k]));
  return run;
}

RuntimeRun
runtimeRunOf(const PaperProblem& problem, const PaperRunName& name)
{
  DrawPlan plan;
  plan.num_draws = 1000;
  plan.seed = name.seed;
  plan.num_threads = name.number;
  const double begin = io::wallSeconds();
  const SamplerRun made = paperMethod(name.method).run(problem, plan);
  if (made.chains.chains.empty())
    return {name, std::nan(""), std::nan(""), made.status};
  return {name, io::wallSeconds() - begin, made.seconds, made.status};
}

void
distributionExperiment(const PaperStudy& study)
{
  ExperimentRuns<DistributionRun> runs(
      study,
      "distribution",
      "KL(baseline || method) [nats], and NEES / 6 of the truth",
      {{"x"}, {"y"}, {"z"}, {"roll"}, {"pitch"}, {"yaw"}, {"6-D"}, {"NEES/6"}});
  std::vector<ComparedPair> pairs;
  pairs.reserve(study.pairs.size());
  for (const ScanPair& pair : study.pairs) {
    const ComparedPair& compared = pairs.emplace_back(study, pair);
    runs.addPair(pair, compared.key);
    for (const PaperMethod& method : paperMethods()) {
      for (const std::uint64_t seed : study.options.seeds()) {
        const PaperRunName name{compared.key, pair.name, method.name, seed};
        const DistributionRun& run = runs.find(name, [&] {
          const SamplerRun made = method.run(compared.problem, planOf(study, seed));
          return distributionRunOf(name, pair, made, compared.baseline);
        });
        const Vector6d& kl = run.score.coordinate_kl;
        std::vector<double> numbers(kl.begin(), kl.end());
        numbers.insert(numbers.end(), {run.score.kl, run.nees / 6.0});
        runs.numbers.emplace_back(pair.name + ", " + method.name, numbers);
      }
      runs.reportMade(pair.name + ": " + method.name);
    }
    writePictureData(compared, study.options);
  }
  writeBaselines(study.options.output_folder, pairs);
  runs.finish();
}

void
runtimeExperiment(const PaperStudy& study)
{
  ExperimentRuns<RuntimeRun> runs(
      study, "runtime", "runtime: seconds per 1000 draws", {{"wall [s]"}, {"CPU [s]"}});
  std::vector<PaperProblem> problems;
  problems.reserve(study.pairs.size());
  for (const ScanPair& pair : study.pairs) {
    problems.emplace_back(pair);
    runs.addPair(pair, io::textOfHash(pair.key()));
  }
  for (const char* const method : {"bayesian-icp", "exact", "calibrated"})
    for (const int num_threads : {1, 2, 4}) {
      const std::string group =
          std::string(method) + ", " + std::to_string(num_threads) + " threads";
      for (const PaperProblem& problem : problems)
        for (const std::uint64_t seed : study.options.seeds()) {
          const PaperRunName name{io::textOfHash(problem.pair.key()),
                                  problem.pair.name,
                                  method,
                                  seed,
                                  num_threads};
          const RuntimeRun& run =
              runs.find(name, [&] { return runtimeRunOf(problem, name); });
          runs.numbers.push_back({group, {run.wall_seconds, run.cpu_seconds}});
        }
      study.report("runtime: " + group);
    }
  runs.finish();
}

void
accuracyExperiment(const PaperStudy& study)
{
  const int num_starts = study.options.is_quick ? 5 : 50;
  ExperimentRuns<AccuracyRun> runs(
      study, "accuracy", "accuracy: errors of the final pose", {{"[mm]"}, {"[mrad]"}});
  for (const ScanPair& pair : study.pairs) {
    const PaperProblem problem(pair);
    const std::string key = io::textOfHash(pair.key());
    runs.addPair(pair, key);
    for (const AccuracyMethod& method : accuracyMethods()) {
      for (int i = 0; i < num_starts; ++i) {
        const PaperRunName name{key, pair.name, method.name, study.options.seed, i};
        const AccuracyRun& run = runs.find(
            name, [&] { return accuracyRunOf(study, problem, method, name); });
        runs.numbers.push_back(
            {pair.name + ", " + method.name,
             {1000.0 * run.translation_error, 1000.0 * run.rotation_error}});
      }
      runs.reportMade("accuracy: " + pair.name + ", " + method.name);
    }
  }
  runs.finish(num_starts);
}

} // namespace

std::vector<NamedExperiment>
paperExperiments()
{
  return {
      {"distribution",
       "the paper's Table I: divergence of every method from Monte Carlo ICP",
       R"(KL(baseline || method) of every method, next to the paper's. The baseline is the
results of Monte Carlo ICP. Also marginal densities, pictures of the clouds, and
scores against the true pose.)",
       {},
       distributionExperiment},
      {"samples",
       "the same divergence as a function of the number of draws",
       "KL(baseline || draws) for 100 to 6000 draws. The default pairs are bowl "
       "and can.",
       {},
       [](const PaperStudy& study) { runCurves(study, samples_plan); }},
      {"burn-in",
       "the same divergence as a function of the length of burn-in",
       "KL(baseline || 2000 draws) after a burn-in of 0 to 4000 draws. The default "
       "pairs\n"
       "are bowl and can.",
       {},
       [](const PaperStudy& study) { runCurves(study, burn_in_plan); }},
      {"runtime",
       "seconds per 1000 draws, for 1, 2 and 4 threads",
       R"(Wall time and processor time per 1000 draws of the presets paper, exact and
calibrated for 1, 2 and 4 threads, next to the paper's. Each pair is timed --repeats
times. Run nothing else in the meantime.)",
       {"threads", "baseline-runs", "start-translation", "start-rotation"},
       runtimeExperiment},
      {"accuracy",
       "errors of posterior means, SGD-ICP and ICP from random starts",
       R"(Translation and rotation error of Bayesian ICP's mean (presets paper, exact and
calibrated), SGD-ICP and ICP to completion, from 50 starts within ±1 m, ±0.3 rad (5
with --quick).)",
       {"repeats", "baseline-runs", "start-translation", "start-rotation"},
       accuracyExperiment}};
}

} // namespace bayesian_icp::evaluate
