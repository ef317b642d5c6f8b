#include "coverage/coverage_study.h"

namespace bayesian_icp::evaluate {

namespace {

CoverageRunName
runNameOf(const CoverageCaseName& name, const CoverageMethod& method)
{
  return {name.scene, name.condition, name.seed, method.name};
}

/** One case and the methods that have no row of it yet. */
struct Task {
  const CoverageCaseName* name;
  std::vector<const CoverageMethod*> methods;
};

std::vector<Task>
missingRuns(const CoverageStudy& study, const CoverageFile& results)
{
  std::vector<Task> tasks;
  for (const CoverageCaseName& name : study.cases) {
    Task task{&name, {}};
    for (const CoverageMethod& method : study.methods)
      if (!results.find(runNameOf(name, method)))
        task.methods.push_back(&method);
    if (!task.methods.empty())
      tasks.push_back(std::move(task));
  }
  return tasks;
}

} // namespace

void
runCoverageStudy(const CoverageStudy& study, CoverageFile& results)
{
  const std::vector<Task> missing = missingRuns(study, results);
  StudyTasks tasks;
  tasks.size = missing.size();
  tasks.run = [&](std::size_t i) {
    const auto& [name, methods] = missing[i];
    const CoverageCase problem = study.make_case(*name);
    for (const CoverageMethod* method : methods)
      results.add({runNameOf(*name, *method),
                   coverageScoreOf(problem, timedResult(*method, problem))});
  };
  if (study.report)
    tasks.report = [&](const StudyProgress& progress, std::size_t i) {
      study.report(progress, *missing[i].name);
    };
  runTasks(tasks, study.num_threads);
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

} // namespace bayesian_icp::evaluate
