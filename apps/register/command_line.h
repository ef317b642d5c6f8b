/** \file
 * \brief The command line of pcl_bayesian_icp.
 */
#pragma once

#include "register/export_files.h"
#include "register/settings.h"
#include "register/sgd_settings.h"

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
  /** With --method sgd-icp, in place of the settings above. */
  std::optional<SgdSettings> sgd;
};

/** \brief io::readCommandLine(), and the configuration file that it names.
 * \throws io::UsageError if it cannot be understood, io::FileError if a file cannot be
 *         read */
Request
parseCommandLine(int argc, const char* const* argv);

} // namespace bayesian_icp::app
