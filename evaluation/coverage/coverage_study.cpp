#include "coverage/coverage_study.h"

#include <algorithm>

namespace bayesian_icp::evaluate {

namespace {

CoverageRunName
runNameOf(const CoverageCaseName& name, const CoverageMethod& method)
{
  return {name.scene, name.condition, name.seed, method.name};
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
  runTasks(missing.size(),
           study.num_threads,
           run,
           [&](const StudyProgress& progress, std::size_t i) {
             if (study.report)
               study.report(progress, missing[i]);
           });
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
