/** \file
 * \brief The command line of the simulator.
 */
#pragma once

#include "simulator/simulation.h"

#include <string>

namespace bayesian_icp::simulator {

/** \brief What the user asks for. */
struct Request {
  enum class Kind { Simulate, ShowHelp, ListScenes };
  Kind kind = Kind::Simulate;
  SimulationOptions options;
  std::string output_folder;
};

/** \brief Read the command line.
 * \throws std::exception with a message for the user if it cannot be understood */
Request
parseCommandLine(int argc, const char* const* argv);

/** \brief What --help prints. */
std::string
helpText();

/** \brief What --list-scenes prints. */
std::string
sceneList();

} // namespace bayesian_icp::simulator
