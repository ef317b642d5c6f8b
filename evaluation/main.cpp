/** \file
 * \brief pcl_bayesian_icp_evaluate: studies of the samplers and the posteriors, one
 * sub-command each.
 */
#include "commands.h"
#include "io/errors.h"
#include "io/program.h"

#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

namespace evaluate = bayesian_icp::evaluate;
namespace io = bayesian_icp::io;

using evaluate::SubCommand;

namespace {

std::vector<SubCommand>
subCommands()
{
  std::vector<SubCommand> commands = {
      {"samplers",
       "distance of every sampler's draws to a gold standard, and their rate",
       evaluate::runSamplersCommand},
      {"coverage",
       "posteriors of every method against the true pose, on simulated and real scans",
       evaluate::runCoverageCommand},
      {"sbc",
       "simulation-based calibration: ranks of true poses among draws of the samplers",
       evaluate::runSbcCommand},
      {"cycles",
       "closures of the cycles of a pose graph against its covariances",
       evaluate::runCyclesCommand},
      {"trajectories",
       "trajectories made of registrations, with the covariances of several methods",
       evaluate::runTrajectoriesCommand},
  };
  for (const SubCommand& command : evaluate::paperCommands())
    commands.push_back(command);
  commands.push_back({"report",
                      "report.md, report.html and figures of the CSV files in a folder",
                      evaluate::runReportCommand});
  return commands;
}

void
printHelp(std::ostream& stream)
{
  stream << "Usage: pcl_bayesian_icp_evaluate COMMAND [options]\n\nCommands:\n";
  for (const SubCommand& command : subCommands())
    stream << "  " << std::left << std::setw(14) << command.name << command.summary
           << '\n';
  stream
      << "\nCOMMAND --help lists its options. --version shows the version.\n"
         "Exit codes: 0 success, 1 do not rely on a result, 2 usage, 3 a file cannot\n"
         "be read or written.\n";
}

int
runTool(int argc, const char* const* argv)
{
  const std::string name = argc > 1 ? argv[1] : "";
  if (name == "--help") {
    printHelp(std::cout);
    return io::Good;
  }
  if (name == "--version") {
    io::print("pcl_bayesian_icp_evaluate " BAYESIAN_ICP_VERSION "\n");
    return io::Good;
  }
  for (const SubCommand& command : subCommands())
    if (command.name == name)
      return command.run(argc - 1, argv + 1);
  throw io::UsageError(name.empty() ? "a command is needed"
                                    : "there is no command " + io::inQuotes(name));
}

} // namespace

int
main(int argc, char** argv)
{
  return io::runProgram("pcl_bayesian_icp_evaluate", [&] {
    const int exit_code = runTool(argc, argv);
    io::print(""); // what was printed must have arrived
    return exit_code;
  });
}
