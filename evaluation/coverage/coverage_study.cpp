#include "coverage/coverage_study.h"

#include "threads/first_exception.h"

#include <chrono>

namespace bayesian_icp::evaluate {

namespace {

CoverageRunName
runNameOf(const CoverageCaseName& name, const CoverageMethod& method)
{
  return {name.scene, name.condition, name.seed, method.name};
}

/** Methods that have no row of a case yet. */
std::vector<const CoverageMethod*>
missingMethods(const CoverageStudy& study,
               const CoverageCaseName& name,
               const CoverageFile& results)
{
  std::vector<const CoverageMethod*> missing;
  for (const CoverageMethod& method : study.methods)
    if (!results.find(runNameOf(name, method)))
      missing.push_back(&method);
  return missing;
}

/** One case and what is to be done with it. */
struct Task {
  CoverageCaseName name;
  std::vector<const CoverageMethod*> methods;
};

/** What the threads share. */
class Runner {
public:
  Runner(const CoverageStudy& study, CoverageFile& results, std::size_t num_tasks)
  : study_(study)
  , results_(results)
  , num_tasks_(num_tasks)
  {}

  void
  run(const Task& task)
  {
    // No exception may leave a parallel region or a critical section.
    failure_.guard([&] {
      const CoverageCase problem = study_.make_case(task.name);
      for (const CoverageMethod* method : task.methods) {
        const CoverageRun run = {
            runNameOf(task.name, *method),
            coverageScoreOf(problem, timedResult(*method, problem))};
#pragma omp critical(coverage_results)
        failure_.guard([&] { results_.add(run); });
      }
#pragma omp critical(coverage_results)
      failure_.guard([&] { report(task.name); });
    });
  }

  void
  rethrow() const
  {
    failure_.rethrow();
  }

private:
  using Clock = std::chrono::steady_clock;

  void
  report(const CoverageCaseName& name)
  {
    ++num_done_;
    const double seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
    const auto num_left = static_cast<double>(num_tasks_ - num_done_);
    if (study_.report)
      study_.report({num_done_,
                     num_tasks_,
                     seconds * num_left / static_cast<double>(num_done_),
                     name});
  }

  const CoverageStudy& study_;
  CoverageFile& results_;
  std::size_t num_tasks_;
  std::size_t num_done_ = 0;
  Clock::time_point begin_ = Clock::now();
  FirstException failure_;
};

} // namespace

void
runCoverageStudy(const CoverageStudy& study, CoverageFile& results)
{
  std::vector<Task> tasks;
  for (const CoverageCaseName& name : study.cases) {
    auto methods = missingMethods(study, name, results);
    if (!methods.empty())
      tasks.push_back({name, std::move(methods)});
  }
  Runner runner(study, results, tasks.size());
#pragma omp parallel for schedule(dynamic) num_threads(study.num_threads)
  for (std::size_t i = 0; i < tasks.size(); ++i)
    runner.run(tasks[i]);
  runner.rethrow();
}

} // namespace bayesian_icp::evaluate
