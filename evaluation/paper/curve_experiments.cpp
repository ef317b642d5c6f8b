#include "paper/baseline_distance.h"
#include "study/text_table.h"
#include "paper/study_record.h"

#include <algorithm>
#include <iostream>

namespace bayesian_icp::evaluate {

namespace {

/** The paper shows these two. */
const std::vector<std::string> shown_objects = {"bowl", "can"};

/** Draws that are taken after burn-in. */
constexpr int num_kept_draws = 2000;

/** Root of the prior's variance: starts as far out as the prior allows. */
constexpr double far_spread = 0.35;

/** Draws of a run. */
constexpr int num_draws = 6000;

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
             RunFile<CurvePoint>& file,
             MedianTable& table)
{
  const PaperProblem& problem = compared.problem;
  for (const std::uint64_t seed : study.options.seeds()) {
    DrawPlan draws;
    draws.num_draws = num_draws;
    draws.seed = seed;
    draws.num_threads = study.options.num_threads;
    draws.initial_spread = variant.initial_spread;
    ChainSet chains; // made for the first point that is missing
    for (const int value : plan.values) {
      const PaperRunName name{
          compared.key, problem.pair.name, variant.name, seed, value};
      const CurvePoint& point = file.findOrMake(name, [&] {
        if (chains.chains.empty())
          chains = paperMethod(variant.method).run(problem, draws).chains;
        return CurvePoint{
            name,
            curveDivergences(partOf(chains, plan.part(value)), compared.baseline)};
      });
      table.add(problem.pair.name + ", " + variant.name + ", " + std::to_string(value),
                {point.divergences.begin(), point.divergences.end()});
    }
  }
  study.report(problem.pair.name + ": " + plan.name + ", " + variant.name);
}

/** What both experiments are, but for their plan. */
void
runCurves(const PaperStudy& study, const CurvePlan& plan)
{
  RunFile<CurvePoint> file(study.path(plan.name + ".csv"));
  MedianTable table(plan.name + ": KL(baseline || method) [nats]",
                    {"x", "y", "z", "roll", "pitch", "yaw", "6-D"});
  std::vector<PairKey> keys;
  for (const ScanPair& pair : curvePairs(study)) {
    const ComparedPair compared(study, pair);
    keys.push_back({pair.name, compared.key});
    for (const CurveVariant& variant : plan.variants)
      studyVariant(study, plan, variant, compared, file, table);
  }
  recordExperiment(study, plan.name, keys);
  table.print(std::cout);
}

} // namespace

void
samplesExperiment(const PaperStudy& study)
{
  runCurves(study, samples_plan);
}

void
burnInExperiment(const PaperStudy& study)
{
  runCurves(study, burn_in_plan);
}

} // namespace bayesian_icp::evaluate
