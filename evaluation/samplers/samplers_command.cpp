#include "commands.h"
#include "io/cloud_file.h"
#include "io/folders.h"
#include "samplers/result_table.h"
#include "samplers/study.h"
#include "study/report_program.h"

#include <iostream>
#include <sstream>

namespace bayesian_icp::evaluate {

namespace {

std::string
titleOf(const Problem& problem)
{
  std::ostringstream title;
  title << problem.name() << ", sigma " << problem.cell().sigma << " m, N "
        << problem.cell().effective_points;
  return title.str();
}

} // namespace

int
runSamplersCommand(int argc, const char* const* argv)
{
  const std::optional<SamplersOptions> asked = parseSamplersOptions(argc, argv);
  if (!asked)
    return 0;
  const SamplersOptions& options = *asked;
  io::silencePcl();
  ResultFile results(options.result_file);
  bool all_converged = true;
  for (const std::string& name : options.scenes) {
    const Scene scene = readScene(
        options.data_folder, name, static_cast<std::size_t>(options.num_points));
    for (const Cell& cell : options.cells) {
      const Problem problem(scene, cell, options.residual);
      const std::string title = titleOf(problem);
      const Study::Report report = [&title](const std::string& line) {
        std::cerr << title << ": " << line << std::endl;
      };
      all_converged &= Study(problem, options, results, report).run();
    }
  }
  printTable(results.runs(), std::cout);
  const int report_code =
      options.has_report ? makeReport(io::folderOf(options.result_file)) : 0;
  return all_converged ? report_code : 1;
}

} // namespace bayesian_icp::evaluate
