/** \file
 * \brief The command line of pcl_bayesian_icp_pose_graph.
 */
#pragma once

#include "pose_graph/scan_graph.h"

#include <string>

namespace bayesian_icp::app {

/** \brief What the user asks for. */
struct GraphCommand {
  enum class Kind { MakeGraph, ShowHelp, ShowVersion };
  Kind kind = Kind::MakeGraph;
  GraphRequest request;
  std::string output_file;
  bool is_quiet = false;
  /** Something that the user ought to know; empty if nothing. */
  std::string note;
};

/** \brief Read the command line, and look into the folder that it names.
 * \throws io::UsageError if it cannot be understood, io::FileError if a file cannot be
 *         read */
GraphCommand
parseGraphCommand(int argc, const char* const* argv);

/** \brief What --help prints. */
std::string
graphHelpText();

} // namespace bayesian_icp::app
