/** \file
 * \brief The command line of pcl_bayesian_icp_viewer.
 */
#pragma once

#include "register/settings.h"
#include "viewer/view_options.h"

#include <string>

namespace bayesian_icp::viewer {

/** \brief What the user asks for. */
struct Request {
  /** A saved posterior; empty if the clouds are to be registered. */
  std::string posterior_file;
  /** Empty if the names in the posterior are to be used. */
  std::string source_file;
  std::string target_file;
  app::Settings settings;
  ViewOptions view;
  bool is_quiet = false;
};

/** \brief io::readCommandLine(), and the configuration file that it names.
 * \throws io::UsageError if it cannot be understood, io::FileError if a configuration
 *         file cannot be read */
Request
parseCommandLine(int argc, const char* const* argv);

} // namespace bayesian_icp::viewer
