/** \file
 * \brief pcl_bayesian_icp_simulate: scans a made-up scene twice and writes the two
 * clouds with the transform between them.
 */
#include "command_line.h"
#include "output.h"

#include <exception>
#include <iostream>

namespace simulator = bayesian_icp::simulator;

namespace {

enum ExitCode { Good = 0, Usage = 2, CannotWrite = 3 };

int
fail(ExitCode code, const std::exception& error)
{
  std::cerr << "pcl_bayesian_icp_simulate: " << error.what() << '\n';
  if (code == Usage)
    std::cerr << "Try pcl_bayesian_icp_simulate --help\n";
  return code;
}

int
write(const simulator::Request& request, const simulator::ScanPair& pair)
{
  try {
    simulator::writePair(request.output_folder, request.options, pair);
  }
  catch (const std::exception& error) {
    return fail(CannotWrite, error);
  }
  std::cout << request.output_folder << ": " << request.options.scene << ", source "
            << pair.source.cols() << " points, target " << pair.target.cols()
            << " points\n";
  return Good;
}

} // namespace

int
main(int argc, char** argv)
{
  simulator::Request request;
  simulator::ScanPair pair;
  try {
    request = simulator::parseCommandLine(argc, argv);
    if (request.kind == simulator::Request::Kind::Simulate)
      pair = simulator::simulate(request.options);
  }
  catch (const std::exception& error) {
    return fail(Usage, error);
  }
  switch (request.kind) {
  case simulator::Request::Kind::ShowHelp:
    std::cout << simulator::helpText();
    return Good;
  case simulator::Request::Kind::ListScenes:
    std::cout << simulator::sceneList();
    return Good;
  case simulator::Request::Kind::Simulate:
    break;
  }
  return write(request, pair);
}
