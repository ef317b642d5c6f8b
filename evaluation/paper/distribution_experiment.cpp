#include "paper/median_table.h"
#include "paper/picture_data.h"
#include "paper/study_record.h"

#include <iostream>

namespace bayesian_icp::evaluate {

namespace {

void
printMedians(const std::vector<PairDistribution>& distributions)
{
  MedianTable table("KL(baseline || method) [nats], and NEES / 6 of the truth",
                    {"x", "y", "z", "roll", "pitch", "yaw", "6-D", "NEES/6"});
  for (const PairDistribution& distribution : distributions)
    for (const DistributionRun& run : distribution.runs) {
      const Vector6d& kl = run.score.coordinate_kl;
      std::vector<double> numbers(kl.begin(), kl.end());
      numbers.insert(numbers.end(), {run.score.kl, run.nees / 6.0});
      table.add(run.name.pair + ", " + run.name.method, numbers);
    }
  table.print(std::cout);
}

} // namespace

void
distributionExperiment(const PaperStudy& study)
{
  DistributionFile file(study.path("distribution.csv"));
  std::vector<PairDistribution> distributions;
  std::vector<PairKey> keys;
  for (const ScanPair& pair : study.pairs) {
    const PaperProblem problem(pair);
    keys.push_back({pair.name, baselineKey(study.options, problem)});
    distributions.push_back(studyDistribution(study, problem, file));
    writePictureData(study.options.output_folder,
                     pair,
                     distributions.back().baseline,
                     shownDraws(problem, study.options));
  }
  writeBaselines(study.options.output_folder, distributions);
  recordExperiment(study, "distribution", keys);
  printMedians(distributions);
}

} // namespace bayesian_icp::evaluate
