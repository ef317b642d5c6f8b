#include "commands.h"
#include "io/cloud_file.h"
#include "io/folders.h"
#include "paper/paper_experiment.h"
#include "study/report_program.h"

#include <iostream>

namespace bayesian_icp::evaluate {

namespace {

constexpr int incomplete_exit_code = 3;

using Experiment = std::function<void(const PaperStudy&)>;

struct NamedExperiment {
  /** Of the sub-command. */
  std::string name;
  /** What it does: one line, and more for --help. */
  std::string summary;
  std::string details;
  Experiment run;
};

constexpr char help_of_all[] = R"(

The output folder gets a CSV file with one row for each run, and the data of the
pictures. Python with pandas and matplotlib makes report.md, report.html and the
pictures from these; the tool prints medians without it. An interrupted run
continues where it stopped. A pair that is missing or broken is named and skipped.
Delete the results of another build of the methods yourself.
Exit codes: 0 good, 2 usage, 3 cannot read or write a file, left a pair out, or
made no report.
)";

/** In the order of the report. */
const std::vector<NamedExperiment> experiments = {
    {"distribution",
     "the paper's Table I: divergence of every method from Monte Carlo ICP",
     R"(KL(baseline || method) of every method, the baseline being the results of
Monte Carlo ICP, beside the paper's; marginal densities, pictures of the clouds,
and scores against the true pose.)",
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
     R"(Wall time and processor time per 1000 draws of the presets paper, exact and
calibrated for 1, 2 and 4 threads, beside the paper's; each pair is timed as often
as there are repeats. Run nothing else meanwhile.)",
     runtimeExperiment},
    {"accuracy",
     "errors of posterior means, SGD-ICP and ICP from random starts",
     R"(Translation and rotation error of Bayesian ICP's mean (presets paper, exact and
calibrated), SGD-ICP and ICP to completion, from 50 starts in ±1 m, ±0.3 rad (5 with
--quick).)",
     accuracyExperiment}};

/** Read options and pairs, make the output folder, run the experiments, and have the
 * report made; progress goes to the standard error. */
int
runExperiments(const std::string& summary,
               const Experiment& run,
               int argc,
               const char* const* argv)
{
  PaperStudy study;
  study.command = argv[0];
  const auto options =
      readPaperOptions(argc,
                       argv,
                       "Usage: pcl_bayesian_icp_evaluate " + study.command +
                           " [options]\n\n" + summary + help_of_all);
  if (!options)
    return 0;
  study.options = *options;
  io::silencePcl();
  study.pairs = readPairs(study.options, std::cerr, study.num_skipped);
  study.report = [](const std::string& line) { std::cerr << line << std::endl; };
  io::makeFolder(study.options.output_folder);
  run(study);
  if (study.num_skipped > 0)
    std::cerr << study.num_skipped << " pairs were skipped" << std::endl;
  const int report_code =
      study.options.has_report ? makeReport(study.options.output_folder) : 0;
  return study.num_skipped > 0 ? incomplete_exit_code : report_code;
}

} // namespace

std::vector<SubCommand>
paperCommands()
{
  std::string summary =
      "All experiments of the paper into one folder, and a report of them:";
  for (const NamedExperiment& experiment : experiments)
    summary += "\n  " + experiment.name + ": " + experiment.summary;
  const auto runAll = [](const PaperStudy& study) {
    for (const NamedExperiment& experiment : experiments) {
      study.report("experiment " + experiment.name);
      experiment.run(study);
    }
  };
  const auto runner = [](const std::string& help, const Experiment& run) {
    return [=](int argc, const char* const* argv) {
      return runExperiments(help, run, argc, argv);
    };
  };
  std::vector<SubCommand> commands = {
      {"paper",
       "the paper's whole evaluation: all experiments below, and a report",
       runner(summary, runAll)}};
  for (const auto& [name, line, details, run] : experiments)
    commands.push_back({name, line, runner(details, run)});
  return commands;
}

} // namespace bayesian_icp::evaluate
