#include "paper/paper_command.h"

namespace bayesian_icp::evaluate {

const std::vector<NamedExperiment>&
paperExperiments()
{
  static const std::vector<NamedExperiment> experiments = {
      {"distribution",
       "the paper's Table I: divergence of every method from Monte Carlo ICP",
       "KL(baseline || method) of every method, the baseline being the results of\n"
       "Monte Carlo ICP, beside the paper's; marginal densities, pictures of the "
       "clouds,\n"
       "and scores against the true pose.",
       distributionExperiment},
      {"samples",
       "the same divergence as a function of the number of draws",
       "KL(baseline || draws) for 100 to 6000 draws; bowl and can, unless pairs are "
       "given.",
       samplesExperiment},
      {"burn-in",
       "the same divergence as a function of the length of burn-in",
       "KL(baseline || 2000 draws) after 0 to 4000 draws that are left out; bowl and "
       "can,\n"
       "unless pairs are given.",
       burnInExperiment},
      {"runtime",
       "seconds per 1000 draws, for 1, 2 and 4 threads",
       "Wall time and processor time per 1000 draws of the presets paper, exact and\n"
       "calibrated for 1, 2 and 4 threads, beside the paper's; each pair is timed as "
       "often\nas there are repeats. Run nothing else meanwhile.",
       runtimeExperiment},
      {"accuracy",
       "errors of posterior means, SGD-ICP and ICP from random starts",
       "Translation and rotation error of Bayesian ICP's mean (presets paper, exact "
       "and\n"
       "calibrated), SGD-ICP and ICP to completion, from 50 starts in ±1 m, ±0.3 rad "
       "(5 with\n--quick).",
       accuracyExperiment}};
  return experiments;
}

int
runPaperCommand(int argc, const char* const* argv)
{
  std::string summary =
      "All experiments of the paper into one folder, and a report of them:";
  for (const NamedExperiment& experiment : paperExperiments())
    summary += "\n  " + experiment.name + ": " + experiment.summary;
  const auto run_all = [](const PaperStudy& study) {
    for (const NamedExperiment& experiment : paperExperiments()) {
      study.report("experiment " + experiment.name);
      experiment.run(study);
    }
  };
  return runExperiments({summary, run_all}, argc, argv);
}

} // namespace bayesian_icp::evaluate
