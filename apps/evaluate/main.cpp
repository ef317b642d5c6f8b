/** \file
 * \brief pcl_bayesian_icp_evaluate: studies of the samplers and the posteriors, one
 * sub-command each.
 */
#include "coverage_command.h"
#include "samplers_command.h"
#include "sbc_command.h"

#include <boost/program_options/errors.hpp>

#include <io/errors.h>

#include <cstring>
#include <exception>
#include <iostream>

namespace {

enum ExitCode { Good = 0, NotReached = 1, BadUsage = 2, BadFile = 3 };

struct SubCommand {
  const char* name;
  const char* summary;
  /** The exit code Good or NotReached; throws for the others. */
  int (*run)(int argc, const char* const* argv);
};

const SubCommand sub_commands[] = {
    {"samplers",
     "distance of every sampler's draws to a gold standard, and their rate",
     bayesian_icp::evaluate::runSamplersCommand},
    {"coverage",
     "posteriors of every method against the true pose, on simulated and real scans",
     bayesian_icp::evaluate::runCoverageCommand},
    {"sbc",
     "simulation-based calibration: ranks of true poses among draws of the samplers",
     bayesian_icp::evaluate::runSbcCommand},
};

void
printHelp(std::ostream& stream)
{
  stream << "Usage: pcl_bayesian_icp_evaluate COMMAND [options]\n\nCommands:\n";
  for (const SubCommand& command : sub_commands)
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
  const char* name = argc > 1 ? argv[1] : "";
  if (std::strcmp(name, "--help") == 0) {
    printHelp(std::cout);
    return Good;
  }
  for (const SubCommand& command : sub_commands)
    if (std::strcmp(command.name, name) == 0)
      return run(command, argc - 1, argv + 1);
  printHelp(std::cerr);
  return BadUsage;
}
