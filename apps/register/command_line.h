/** \file
 * \brief The command line of pcl_bayesian_icp.
 */
#pragma once

#include "register/export_files.h"
#include "register/settings.h"

#include <string>

namespace bayesian_icp::app {

/** \brief What the user asks for. */
struct Request {
  enum class Kind { Register, ShowHelp, ShowVersion };
  Kind kind = Kind::Register;
  std::string source_file;
  std::string target_file;
  /** Empty if no files are wanted. */
  std::string output_folder;
  /** Without formats if nothing is to be exported. */
  ExportRequest exports;
  bool is_json = false;
  bool is_quiet = false;
  Settings settings;
  /** Something in a configuration file that the user ought to know; empty if nothing.
   */
  std::string note;
};

/** \brief Read the command line, and the configuration file that it names.
 * \throws io::UsageError if it cannot be understood, io::FileError if a file cannot be
 *         read */
Request
parseCommandLine(int argc, const char* const* argv);

/** \brief What --help prints. */
std::string
helpText();

} // namespace bayesian_icp::app
