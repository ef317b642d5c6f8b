/** \file
 * \brief Options of the sub-command `coverage`.
 */
#pragma once

#include "coverage/coverage_sequences.h"
#include "study/option_values.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief What is run, and where it is kept. */
struct CoverageOptions {
  /** Names as given; empty: all there are, but for the scenes of the set lidar. */
  std::vector<std::string> scenes;
  std::vector<std::string> conditions;
  std::vector<std::string> methods;
  int num_seeds = 20;
  std::uint64_t first_seed = 1;
  ResultOptions result = {"results/coverage.csv"};
  /** Folder of real pairs with a manifest.json, or of recordings; empty: simulated
   * scenes. */
  std::string real_folder;
  bool has_sequences = false;
  SequenceOptions sequences;
  int num_threads = 1;
  /** Few scenes and one condition where none are given. */
  bool is_quick = false;
};

/** \brief Read the command line.
 * \return nothing if it asks for help, which has been printed
 * \throws io::UsageError with a message for the user */
std::optional<CoverageOptions>
parseCoverageOptions(int argc, const char* const* argv);

} // namespace bayesian_icp::evaluate
