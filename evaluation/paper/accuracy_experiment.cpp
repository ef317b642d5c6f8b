#include "geometry/twist.h"
#include "io/text_hash.h"
#include "paper/accuracy_methods.h"
#include "study/text_table.h"
#include "paper/paper_runs.h"
#include "paper/study_record.h"

#include <cmath>
#include <iostream>

namespace bayesian_icp::evaluate {

namespace {

constexpr int num_starts = 50;
constexpr int num_quick_starts = 5;

int
numStarts(const PaperStudy& study)
{
  return study.options.is_quick ? num_quick_starts : num_starts;
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
makeRun(const PaperProblem& problem,
        const AccuracyMethod& method,
        const PaperRunName& name,
        int num_threads)
{
  DrawPlan plan;
  plan.start = startOf(name);
  plan.seed = name.seed + static_cast<std::uint64_t>(name.number);
  plan.num_threads = num_threads;
  const AccuracyEstimate estimate = method.run(problem, plan);
  const Vector6d error = estimate.pose - poseOf(problem.pair.truth.matrix());
  AccuracyRun run{name, error.head<3>().norm(), 0.0, estimate.status};
  for (int k = 3; k < 6; ++k)
    run.rotation_error += std::abs(wrapAngle(error[k]));
  return run;
}

/** The runs of one method on one pair; those that are missing are made. */
void
studyMethod(const PaperStudy& study,
            const PaperProblem& problem,
            const AccuracyMethod& method,
            RunFile<AccuracyRun>& file,
            MedianTable& table)
{
  int num_made = 0;
  for (int i = 0; i < numStarts(study); ++i) {
    const PaperRunName name{io::textOfHash(problem.pair.key()),
                            problem.pair.name,
                            method.name,
                            study.options.seed,
                            i};
    const AccuracyRun& run = file.findOrMake(name, [&] {
      ++num_made;
      return makeRun(problem, method, name, study.options.num_threads);
    });
    table.add(problem.pair.name + ", " + method.name,
              {1000.0 * run.translation_error, 1000.0 * run.rotation_error});
  }
  if (num_made > 0)
    study.report("accuracy: " + problem.pair.name + ", " + method.name + ", " +
                 std::to_string(num_made) + " runs");
}

} // namespace

void
accuracyExperiment(const PaperStudy& study)
{
  RunFile<AccuracyRun> file(study.path("accuracy.csv"));
  MedianTable table("accuracy: errors of the final pose", {"[mm]", "[mrad]"});
  std::vector<PairKey> keys;
  for (const ScanPair& pair : study.pairs) {
    const PaperProblem problem(pair);
    keys.push_back({pair.name, io::textOfHash(pair.key())});
    for (const AccuracyMethod& method : accuracyMethods())
      studyMethod(study, problem, method, file, table);
  }
  recordExperiment(study, "accuracy", keys, numStarts(study));
  table.print(std::cout);
}

} // namespace bayesian_icp::evaluate
