#include "paper/baseline_distance.h"
#include "study/text_table.h"
#include "paper/picture_data.h"
#include "paper/study_record.h"

#include <iostream>

namespace bayesian_icp::evaluate {

namespace {

using DistributionFile = RunFile<DistributionRun>;

void
addTo(MedianTable& table, const DistributionRun& run)
{
  const Vector6d& kl = run.score.coordinate_kl;
  std::vector<double> numbers(kl.begin(), kl.end());
  numbers.insert(numbers.end(), {run.score.kl, run.nees / 6.0});
  table.add(run.name.pair + ", " + run.name.method, numbers);
}

/** The runs of one method on one pair; those that are missing are made. */
void
studyMethod(const PaperStudy& study,
            const ComparedPair& compared,
            const PaperMethod& method,
            DistributionFile& file,
            MedianTable& table)
{
  const PaperProblem& problem = compared.problem;
  int num_made = 0;
  for (const std::uint64_t seed : study.options.seeds()) {
    const PaperRunName name{compared.key, problem.pair.name, method.name, seed};
    const DistributionRun& run = file.findOrMake(name, [&] {
      ++num_made;
      DrawPlan plan;
      plan.seed = seed;
      plan.num_threads = study.options.num_threads;
      return distributionRunOf(
          name, problem.pair, method.run(problem, plan), compared.baseline);
    });
    addTo(table, run);
  }
  if (num_made > 0)
    study.report(problem.pair.name + ": " + method.name + ", " +
                 std::to_string(num_made) + " runs");
}

} // namespace

void
distributionExperiment(const PaperStudy& study)
{
  DistributionFile file(study.path("distribution.csv"));
  MedianTable table("KL(baseline || method) [nats], and NEES / 6 of the truth",
                    {"x", "y", "z", "roll", "pitch", "yaw", "6-D", "NEES/6"});
  std::vector<ComparedPair> pairs;
  pairs.reserve(study.pairs.size());
  std::vector<PairKey> keys;
  for (const ScanPair& pair : study.pairs) {
    const ComparedPair& compared = pairs.emplace_back(study, pair);
    for (const PaperMethod& method : paperMethods())
      studyMethod(study, compared, method, file, table);
    writePictureData(compared, study.options);
    keys.push_back({pair.name, compared.key});
  }
  writeBaselines(study.options.output_folder, pairs);
  recordExperiment(study, "distribution", keys);
  table.print(std::cout);
}

} // namespace bayesian_icp::evaluate
