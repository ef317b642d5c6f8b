/** \file
 * \brief Options of the sub-command `sbc`.
 */
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief What is run, and where it is kept. */
struct SbcOptions {
  bool show_help = false;
  /** Names as given; empty: all there are. */
  std::vector<std::string> samplers;
  int num_runs = 500;
  std::uint64_t first_seed = 1;
  std::string result_file;
  /** Empty: no plots. */
  bool has_report = false;
  int num_threads = 1;
};

/** \throws io::UsageError or boost::program_options::error with a message for the user
 */
SbcOptions
parseSbcOptions(int argc, const char* const* argv);

/** \brief What --help prints. */
std::string
sbcHelp();

} // namespace bayesian_icp::evaluate
