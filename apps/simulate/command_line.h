/** \file
 * \brief The command line of the simulator.
 */
#pragma once

#include "simulator/simulation.h"

#include <optional>
#include <string>

namespace bayesian_icp::simulator {

/** \brief What the user asks for. */
struct Request {
  SimulationOptions options;
  std::string output_folder;
};

/** \brief Read the command line.
 * \return nothing if it asks for help or the list of scenes, which has been printed
 * \throws io::UsageError, or std::invalid_argument with a message for the user, if it
 *         cannot be understood */
std::optional<Request>
parseCommandLine(int argc, const char* const* argv);

} // namespace bayesian_icp::simulator
