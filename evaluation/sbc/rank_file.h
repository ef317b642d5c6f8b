/** \file
 * \brief The runs of simulation-based calibration and the CSV file that keeps them.
 */
#pragma once

#include "sbc/rank_statistics.h"
#include "study/run_file.h"

#include <stdexcept>
#include <string>

namespace bayesian_icp::evaluate {

/** \brief One run of one sampler. */
struct RankRun {
  static constexpr int num_name_columns = 2;

  struct Name {
    std::string sampler;
    std::uint64_t seed = 0;
  };

  Name name;
  /** Whether the draws were good; without it there are no ranks. */
  bool is_valid = false;
  Ranks ranks = Ranks::Zero();

  /** \throws std::runtime_error of what is no rank */
  template <typename Self, typename Column>
  static void
  columns(Self& self, const Column& column)
  {
    column("sampler", self.name.sampler);
    column("seed", self.name.seed);
    column("valid", self.is_valid);
    coordinateColumns("rank_", self.ranks, column);
    if (self.ranks.minCoeff() < 0 || self.ranks.maxCoeff() > num_ranked_draws)
      throw std::runtime_error("not a rank");
  }
};

using RankFile = RunFile<RankRun>;

} // namespace bayesian_icp::evaluate
