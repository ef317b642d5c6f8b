/** \file
 * \brief Options of the sub-command `samplers`.
 */
#pragma once

#include "samplers/sampler_problem.h"

#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief What is compared, and where it is kept. */
struct SamplersOptions {
  bool show_help = false;
  std::string data_folder;
  std::string cache_folder;
  std::string result_file;
  bool has_report = false;
  std::vector<std::string> scenes;
  std::vector<Cell> cells;
  std::vector<std::string> samplers;
  int num_seeds = 5;
  int num_points = 2000;
  int num_threads = 1;
  /** Step sizes of Algorithm 1 that are tried. */
  std::vector<double> step_sizes;
  GoldOptions gold;

  /** \brief Whether a sampler was asked for. */
  bool
  wants(const std::string& sampler) const;
};

/** \throws io::UsageError or boost::program_options::error with a message for the user
 */
SamplersOptions
parseSamplersOptions(int argc, const char* const* argv);

/** \brief What --help prints. */
std::string
samplersHelp();

} // namespace bayesian_icp::evaluate
