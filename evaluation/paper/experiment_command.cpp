#include "option_values.h"
#include "paper/paper_experiment.h"

#include <io/cloud_file.h>
#include <io/folders.h>
#include <plot/gnuplot.h>

#include <iostream>

namespace bayesian_icp::evaluate {

namespace {

constexpr int skipped_exit_code = 3;

void
printHelp(const std::string& name, const std::string& summary)
{
  std::cout << "Usage: pcl_bayesian_icp_evaluate " << name << " [options]\n\n"
            << summary
            << "\n\nResults are in the output folder: a CSV file with a row a run, "
               "and plots (SVG\nand PNG, by gnuplot). An interrupted run goes on where "
               "it stopped. A pair that\nis missing or broken is named and left out. "
               "Results of another build of the\nmethods have to be deleted by hand.\n"
               "Exit codes: 0 good, 2 usage, 3 cannot read or write a file, or left a "
               "pair out.\n\n"
            << paperOptionsDescription();
}

} // namespace

int
runExperiments(const ExperimentCommand& command, int argc, const char* const* argv)
{
  PaperStudy study;
  study.options =
      paperOptionsOf(readCommandLine(argc, argv, paperOptionsDescription()));
  if (study.options.show_help) {
    printHelp(argv[0], command.summary);
    return 0;
  }
  io::silencePcl();
  plot::requireGnuplot("--output");
  study.pairs = readPairs(study.options, std::cerr, study.num_skipped);
  study.report = [](const std::string& line) { std::cerr << line << std::endl; };
  io::makeFolder(study.options.output_folder);
  command.run(study);
  if (study.num_skipped > 0)
    std::cerr << study.num_skipped << " pairs were skipped" << std::endl;
  return study.num_skipped > 0 ? skipped_exit_code : 0;
}

int
runExperimentCommand(const Experiment& experiment,
                     const std::string& summary,
                     int argc,
                     const char* const* argv)
{
  const auto run = [&experiment](const PaperStudy& study) {
    writeMarkdown(experiment(study), std::cout);
  };
  return runExperiments({summary, run}, argc, argv);
}

} // namespace bayesian_icp::evaluate
