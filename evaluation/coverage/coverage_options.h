/** \file
 * \brief Options of the sub-command `coverage`.
 */
#pragma once

#include "coverage/coverage_sequences.h"

#include <cstdint>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief What is run, and where it is kept. */
struct CoverageOptions {
  bool show_help = false;
  /** Names as given; empty: all there are, but for the scenes of the set lidar. */
  std::vector<std::string> scenes;
  std::vector<std::string> conditions;
  std::vector<std::string> methods;
  int num_seeds = 20;
  std::uint64_t first_seed = 1;
  std::string result_file;
  /** Folder of real pairs with a manifest.json, or of recordings; empty: simulated
   * scenes. */
  std::string real_folder;
  bool has_sequences = false;
  SequenceOptions sequences;
  bool has_report = false;
  int num_threads = 1;
  /** Few scenes and one condition where none are given. */
  bool is_quick = false;
};

/** \throws io::UsageError or boost::program_options::error with a message for the user
 */
CoverageOptions
parseCoverageOptions(int argc, const char* const* argv);

/** \brief What --help prints. */
std::string
coverageHelp();

} // namespace bayesian_icp::evaluate
