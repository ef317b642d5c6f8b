#include "io/cloud_file.h"
#include "io/folders.h"
#include "paper/paper_experiment.h"
#include "study/option_values.h"
#include "study/report_program.h"

#include <iostream>

namespace bayesian_icp::evaluate {

namespace {

constexpr int incomplete_exit_code = 3;

void
printHelp(const std::string& name, const std::string& summary)
{
  std::cout << "Usage: pcl_bayesian_icp_evaluate " << name << " [options]\n\n"
            << summary << R"(

The output folder gets a CSV file with one row for each run, and the data of the
pictures. Python with pandas and matplotlib makes report.md, report.html and the
pictures from these; the tool prints medians without it. An interrupted run
continues where it stopped. A pair that is missing or broken is named and skipped.
Delete the results of another build of the methods yourself.
Exit codes: 0 good, 2 usage, 3 cannot read or write a file, left a pair out, or
made no report.

)" << paperOptionsDescription();
}

} // namespace

int
runExperiments(const ExperimentCommand& command, int argc, const char* const* argv)
{
  PaperStudy study;
  study.command = argv[0];
  study.options =
      paperOptionsOf(readCommandLine(argc, argv, paperOptionsDescription()));
  if (study.options.show_help) {
    printHelp(argv[0], command.summary);
    return 0;
  }
  io::silencePcl();
  study.pairs = readPairs(study.options, std::cerr, study.num_skipped);
  study.report = [](const std::string& line) { std::cerr << line << std::endl; };
  io::makeFolder(study.options.output_folder);
  command.run(study);
  if (study.num_skipped > 0)
    std::cerr << study.num_skipped << " pairs were skipped" << std::endl;
  const int report_code =
      study.options.has_report ? makeReport(study.options.output_folder) : 0;
  return study.num_skipped > 0 ? incomplete_exit_code : report_code;
}

} // namespace bayesian_icp::evaluate
