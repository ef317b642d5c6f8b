/** \file
 * \brief pcl_bayesian_icp_simulate: scans a simulated scene twice and writes the two
 * clouds with the transform between them.
 */
#include "io/interrupt.h"
#include "io/program.h"
#include "simulate/command_line.h"
#include "simulate/output.h"

#include <stdexcept>

namespace io = bayesian_icp::io;
namespace simulator = bayesian_icp::simulator;

namespace {

int
runTool(int argc, const char* const* argv)
{
  std::optional<simulator::Request> request;
  simulator::ScanPair pair;
  try {
    request = simulator::parseCommandLine(argc, argv);
    if (!request)
      return 0;
    pair = simulator::simulate(request->options);
  }
  catch (const std::invalid_argument& error) {
    throw io::UsageError(error.what());
  }
  io::catchInterrupt(); // from here on all files or none
  simulator::writePair(request->output_folder, request->options, pair);
  io::print(request->output_folder + ": " + request->options.scene + ", source " +
            std::to_string(pair.source.cols()) + " points, target " +
            std::to_string(pair.target.cols()) + " points\n");
  return io::wasInterrupted() ? io::Interrupted : 0;
}

} // namespace

int
main(int argc, char** argv)
{
  return io::runProgram("pcl_bayesian_icp_simulate",
                        [&] { return runTool(argc, argv); });
}
