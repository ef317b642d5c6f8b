/** \file
 * \brief Options of the sub-command `samplers`.
 */
#pragma once

#include "samplers/sampler_problem.h"
#include "study/option_values.h"

#include <optional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief What is compared, and where it is kept. */
struct SamplersOptions {
  std::string data_folder = "data";
  std::string cache_folder = "results";
  ResultOptions result = {"results/samplers.csv"};
  bool is_quick = false;
  std::vector<std::string> scenes = {"can", "bowl", "mug", "table", "corridor"};
  std::vector<Cell> cells;
  std::vector<std::string> samplers = {"exact",
                                       "exact-metropolis",
                                       "stein-gradient",
                                       "stein-newton",
                                       "paper",
                                       "walk",
                                       "mala"};
  Residual residual = Residual::PointToPoint;
  /** Numbers of particles that Stein samplers are tried with. */
  std::vector<int> particles;
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

/** \brief Read the command line.
 * \return nothing if it asks for help, which has been printed
 * \throws io::UsageError with a message for the user */
std::optional<SamplersOptions>
parseSamplersOptions(int argc, const char* const* argv);

} // namespace bayesian_icp::evaluate
