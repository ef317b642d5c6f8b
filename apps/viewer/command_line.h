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
  enum class Kind { Show, ShowHelp, ShowVersion };
  Kind kind = Kind::Show;
  /** A saved posterior; empty if the clouds are to be registered. */
  std::string posterior_file;
  /** Empty if the names in the posterior are to be used. */
  std::string source_file;
  std::string target_file;
  app::Settings settings;
  ViewOptions view;
  bool is_quiet = false;
  /** Something about the settings that the user ought to know; empty if nothing. */
  std::string note;
};

/** \brief Read the command line.
 * \throws io::UsageError if it cannot be understood, io::FileError if a configuration
 *         file cannot be read */
Request
parseCommandLine(int argc, const char* const* argv);

/** \brief What --help prints. */
std::string
helpText();

} // namespace bayesian_icp::viewer
