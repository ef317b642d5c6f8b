/** \file
 * \brief The command line of pcl_bayesian_icp_track.
 */
#pragma once

#include "track/tracker.h"

#include <string>

namespace bayesian_icp::app {

/** \brief What the user asks for. */
struct TrackCommand {
  TrackRequest request;
  std::string output_folder;
  bool is_quiet = false;
  /** As a shell takes it. */
  std::string command;
};

/** \brief io::readCommandLine(), and look into the folder that it names.
 * \throws io::UsageError if it cannot be understood, io::FileError if a file cannot be
 *         read */
TrackCommand
parseTrackCommand(int argc, const char* const* argv);

} // namespace bayesian_icp::app
