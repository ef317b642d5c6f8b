/** \file
 * \brief pcl_bayesian_icp_evaluate: studies of the samplers and the posteriors, one
 * sub-command each.
 */
#include "coverage_command.h"
#include "paper_command.h"
#include "samplers_command.h"
#include "sbc_command.h"

#include <boost/program_options/errors.hpp>

#include <io/errors.h>

#include <exception>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

namespace {

enum ExitCode { Good = 0, NotReached = 1, BadUsage = 2, BadFile = 3 };

struct SubCommand {
  std::string name;
  std::string summary;
  /** The exit code Good, NotReached or BadFile; throws for the others and for BadFile.
   */
  std::function<int(int argc, const char* const* argv)> run;
};

std::vector<SubCommand>
subCommands()
{
  namespace evaluate = bayesian_icp::evaluate;
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
      {"paper",
       "the paper's whole evaluation: all experiments below, and a report",
       evaluate::runPaperCommand},
  };
  for (const evaluate::NamedExperiment& experiment : evaluate::paperExperiments())
    commands.push_back({experiment.name,
                        experiment.summary,
                        [&experiment](int argc, const char* const* argv) {
                          return evaluate::runExperimentCommand(
                              experiment.run, experiment.details, argc, argv);
                        }});
  return commands;
}

void
printHelp(std::ostream& stream)
{
  stream << "Usage: pcl_bayesian_icp_evaluate COMMAND [options]\n\nCommands:\n";
  for (const SubCommand& command : subCommands())
    stream << "  " << command.name << "  " << command.summary << '\n';
  stream
      << "\nCOMMAND --help tells its options. Exit codes: 0 good, 1 a result is not\n"
         "to be relied on, 2 usage, 3 cannot read or write a file.\n";
}

int
fail(ExitCode code, const std::exception& error)
{
  std::cerr << "pcl_bayesian_icp_evaluate: " << error.what() << '\n';
  if (code == BadUsage)
    std::cerr << "Try pcl_bayesian_icp_evaluate --help\n";
  return code;
}

int
run(const SubCommand& command, int argc, const char* const* argv)
{
  try {
    return command.run(argc, argv);
  }
  catch (const bayesian_icp::io::UsageError& error) {
    return fail(BadUsage, error);
  }
  catch (const boost::program_options::error& error) {
    return fail(BadUsage, error);
  }
  catch (const std::exception& error) {
    return fail(BadFile, error);
  }
}

} // namespace

int
main(int argc, char** argv)
{
  const std::string name = argc > 1 ? argv[1] : "";
  if (name == "--help") {
    printHelp(std::cout);
    return Good;
  }
  for (const SubCommand& command : subCommands())
    if (command.name == name)
      return run(command, argc - 1, argv + 1);
  printHelp(std::cerr);
  return BadUsage;
}
