/** \file
 * \brief The command line of pcl_bayesian_icp_batch.
 */
#pragma once

#include "register/settings.h"

#include <optional>
#include <string>

namespace bayesian_icp::app {

/** \brief What the user asks for. */
struct BatchRequest {
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
 * \return nothing if it asks for help or version, which has been printed
 * \throws io::UsageError if it cannot be understood, io::FileError if a file cannot be
 *         read */
std::optional<BatchRequest>
parseBatchCommand(int argc, const char* const* argv);

} // namespace bayesian_icp::app
