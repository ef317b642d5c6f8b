/** \file
 * \brief The command line of pcl_bayesian_icp_track.
 */
#pragma once

#include "track/tracker.h"

#include <optional>
#include <string>

namespace bayesian_icp::app {

/** \brief What the user asks for. */
struct TrackCommand {
  TrackRequest request;
  std::string output_folder;
  bool is_quiet = false;
  /** Something that the user ought to know; empty if nothing. */
  std::string note;
  /** As a shell takes it. */
  std::string command;
};

/** \brief Read the command line, and look into the folder that it names.
 * \return nothing if it asks for help or version, which has been printed
 * \throws io::UsageError if it cannot be understood, io::FileError if a file cannot be
 *         read */
std::optional<TrackCommand>
parseTrackCommand(int argc, const char* const* argv);

} // namespace bayesian_icp::app
