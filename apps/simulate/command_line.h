/** \file
 * \brief The command line of the simulator.
 */
#pragma once

#include "simulator/simulation.h"

#include <string>

namespace bayesian_icp::simulator {

/** \brief What the user asks for. */
struct Request {
  SimulationOptions options;
  std::string output_folder;
};

/** \brief io::readCommandLine(), which may also ask for the list of scenes.
 * \throws io::UsageError, or std::invalid_argument with a message for the user, if it
 *         cannot be understood */
Request
parseCommandLine(int argc, const char* const* argv);

} // namespace bayesian_icp::simulator
