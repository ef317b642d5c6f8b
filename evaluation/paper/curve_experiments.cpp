#include "paper/draw_curves.h"
#include "paper/median_table.h"
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

DrawPart
firstDraws(int value)
{
  return {0, value};
}

DrawPart
drawsAfter(int value)
{
  return {value, num_kept_draws};
}

CurvePlan
samplesPlan()
{
  return {"samples",
          {{"bayesian-icp", "bayesian-icp"},
           {"exact", "exact"},
           {"calibrated", "calibrated"}},
          {100, 200, 500, 1000, 1500, 2000, 2500, 3000, 4000, 5000, 6000},
          firstDraws};
}

CurvePlan
burnInPlan()
{
  return {"burn_in",
          {{"near", "bayesian-icp"}, {"far", "bayesian-icp", far_spread}},
          {0, 100, 200, 500, 1000, 1500, 2000, 3000, 4000},
          drawsAfter};
}

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

/** What both experiments are, but for their plan. */
void
runCurves(const PaperStudy& study, const CurvePlan& plan)
{
  CurveFile file(study.path(plan.name + ".csv"));
  MedianTable table(plan.name + ": KL(baseline || method) [nats]",
                    {"x", "y", "z", "roll", "pitch", "yaw", "6-D"});
  std::vector<PairKey> keys;
  for (const ScanPair& pair : curvePairs(study)) {
    const PairCurves curves = studyCurves(study, plan, pair, file);
    keys.push_back({pair.name, curves.key});
    for (const CurvePoint& point : curves.points)
      table.add(pair.name + ", " + point.name.variant + ", " +
                    std::to_string(point.name.value),
                {point.divergences.begin(), point.divergences.end()});
  }
  recordExperiment(study, plan.name, keys);
  table.print(std::cout);
}

} // namespace

void
samplesExperiment(const PaperStudy& study)
{
  runCurves(study, samplesPlan());
}

void
burnInExperiment(const PaperStudy& study)
{
  runCurves(study, burnInPlan());
}

} // namespace bayesian_icp::evaluate
