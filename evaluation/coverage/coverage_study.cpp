#include "coverage/coverage_study.h"

#include "io/coordinates.h"
#include "study/parallel_tasks.h"
#include "study/text_table.h"

#include <algorithm>
#include <map>
#include <set>

namespace bayesian_icp::evaluate {

namespace {

CoverageRunName
runNameOf(const CoverageCaseName& name, const CoverageMethod& method)
{
  return {name.scene, name.condition, name.seed, method.name};
}

const std::vector<SummaryColumn> summary_columns = {{"valid", mean},
                                                    {"lost", mean},
                                                    {"NEES/6", mean},
                                                    {"in 50 %", mean},
                                                    {"in 68 %", mean},
                                                    {"in 90 %", mean},
                                                    {"in 95 %", mean},
                                                    {"log p", mean},
                                                    {"energy", mean},
                                                    {"[mm]"},
                                                    {"[deg]"},
                                                    {"flagged", mean},
                                                    {"outside", mean},
                                                    {"alarms", mean},
                                                    {"misses", mean},
                                                    {"[s]"},
                                                    {"queries"}};

/** One for each of summary_columns. */
std::vector<double>
numbersOf(const CoverageScore& score)
{
  const auto numberIf = [](bool is_known, double number) {
    return is_known ? number : std::nan("");
  };
  const auto isWithin = [&](double level) {
    return numberIf(!std::isnan(score.region), score.region <= level);
  };
  const bool is_doubted = score.isFlagged() || !score.is_valid;
  const bool is_judged = score.hasLimit() && (score.is_valid || !score.hasPose());
  const bool is_good = !score.isLost() && score.nees < max_good_nees;
  const bool is_bad = score.isLost() || score.nees > min_bad_nees;
  return {
      double(score.is_valid),
      numberIf(score.hasLimit(), score.isLost()),
      numberIf(!score.isLost(), score.nees / 6.0),
      isWithin(0.5),
      isWithin(0.68),
      isWithin(0.9),
      isWithin(0.95),
      score.log_score,
      score.energy_score,
      1e3 * score.translation_error,
      app::degrees_per_radian * score.rotation_error,
      numberIf(score.hasPose(), score.isFlagged()),
      numberIf(score.hasPose() && score.region > 0.95, score.isFlagged()),
      numberIf(is_judged && is_good, is_doubted),
      numberIf(is_judged && is_bad, !is_doubted),
      numberIf(score.hasPose(), score.seconds),
      numberIf(score.hasPose() && score.num_queries >= 0, double(score.num_queries))};
}

} // namespace

void
runCoverageStudy(const CoverageStudy& study, CoverageFile& results)
{
  const auto isMissing = [&](const CoverageCaseName& name,
                             const CoverageMethod& method) {
    const CoverageRun* const known = results.find(runNameOf(name, method));
    return known == nullptr || known->inputs != name.inputs;
  };
  std::vector<CoverageCaseName> missing;
  for (const CoverageCaseName& name : study.cases)
    if (std::any_of(study.methods.begin(),
                    study.methods.end(),
                    [&](const auto& method) { return isMissing(name, method); }))
      missing.push_back(name);
  const auto run = [&](std::size_t i) {
    const CoverageCase problem = study.make_case(missing[i]);
    for (const CoverageMethod& method : study.methods)
      if (isMissing(missing[i], method))
        results.add({runNameOf(missing[i], method),
                     coverageScoreOf(problem, timedResult(method, problem)),
                     missing[i].inputs});
  };
  runTasks(missing.size(), study.num_threads, "cases", run);
}

std::vector<CoverageRun>
runsOf(const CoverageStudy& study, const CoverageFile& results)
{
  std::vector<CoverageRun> runs;
  for (const CoverageCaseName& name : study.cases)
    for (const CoverageMethod& method : study.methods)
      if (const CoverageRun* run = results.find(runNameOf(name, method)))
        runs.push_back(*run);
  return runs;
}

std::string
summaryOf(const std::vector<CoverageRun>& runs)
{
  std::map<std::string, std::set<std::string>> scenes; // of each condition
  std::set<std::string> cells;
  std::vector<GroupedNumbers> numbers;
  const auto add = [&](const std::string& title, const CoverageRun& run) {
    numbers.push_back({title + ", " + run.name.method, numbersOf(run.score)});
  };
  for (const CoverageRun& run : runs) {
    const std::string cell = run.name.scene + ", " + run.name.condition;
    scenes[run.name.condition].insert(run.name.scene);
    cells.insert(cell);
    add(cell, run);
  }
  for (const CoverageRun& run : runs)
    if (scenes.size() > 1 && scenes[run.name.condition].size() > 1)
      add("all scenes, " + run.name.condition, run);
  for (const CoverageRun& run : runs)
    if (cells.size() > 1)
      add("all", run);
  return summaryText("runs of", summary_columns, numbers);
}

} // namespace bayesian_icp::evaluate
