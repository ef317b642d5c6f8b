/** \file
 * \brief The command line of pcl_bayesian_icp.
 */
#pragma once

#include "register/export_files.h"
#include "register/settings.h"

#include <boost/program_options/options_description.hpp>

#include <optional>
#include <string>

namespace bayesian_icp::app {

/** \brief What the user asks for. */
struct Request {
  std::string source_file;
  std::string target_file;
  /** Empty if no files are wanted. */
  std::string output_folder;
  /** Without formats if nothing is to be exported. */
  ExportRequest exports;
  bool wants_report = true;
  /** This command line as a shell takes it. */
  std::string command;
  bool is_json = false;
  bool is_quiet = false;
  Settings settings;
  /** Something in a configuration file that the user ought to know; empty if nothing.
   */
  std::string note;
};

/** \brief Read the command line, and the configuration file that it names.
 * \return nothing if it asks for help or version, which has been printed
 * \throws io::UsageError if it cannot be understood, io::FileError if a file cannot be
 *         read */
std::optional<Request>
parseCommandLine(int argc, const char* const* argv);

/** \brief Every option, described with its unit and its default. They fill \p request,
 * which has to outlive them; settingsFrom() reads the settings. */
boost::program_options::options_description
describeOptions(Request& request);

} // namespace bayesian_icp::app
