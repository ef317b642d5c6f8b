/** \file
 * \brief The command line of pcl_bayesian_icp_batch.
 */
#pragma once

#include "register/settings.h"

#include <string>

namespace bayesian_icp::app {

/** \brief What the user asks for. */
struct BatchRequest {
  enum class Kind { Register, ShowHelp, ShowVersion };
  Kind kind = Kind::Register;
  std::string manifest_file;
  /** Empty for standard output. */
  std::string results_file;
  /** Empty if no files of single pairs are wanted. */
  std::string output_folder;
  bool use_suggested_prior = false;
  bool is_quiet = false;
  /** Of pairs that say nothing else. */
  Settings settings;
  /** Something that the user ought to know; empty if nothing. */
  std::string note;
};

/** \brief Read the command line, and the configuration file that it names.
 * \throws io::UsageError if it cannot be understood, io::FileError if a file cannot be
 *         read */
BatchRequest
parseBatchCommand(int argc, const char* const* argv);

/** \brief What --help prints. */
std::string
batchHelpText();

} // namespace bayesian_icp::app
