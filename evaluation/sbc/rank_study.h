/** \file
 * \brief Runs of simulation-based calibration that are not in their file yet, on all
 * cores.
 */
#pragma once

#include "sbc/rank_samplers.h"
#include "study/run_file.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief One run of one sampler. */
struct RankRun {
  struct Name {
    std::string sampler;
    std::uint64_t seed = 0;

    template <typename Self, typename Column>
    static void
    columns(Self& self, const Column& column)
    {
      column("sampler", self.sampler);
      column("seed", self.seed);
    }
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
    Name::columns(self.name, column);
    column("valid", self.is_valid);
    coordinateColumns("rank_", self.ranks, column);
    if (self.ranks.minCoeff() < 0 || self.ranks.maxCoeff() > num_ranked_draws)
      throw std::runtime_error("not a rank");
  }
};

using RankFile = RunFile<RankRun>;

/** \brief What is run. */
struct RankStudy {
  std::vector<RankSampler> samplers;
  int num_runs = 500;
  std::uint64_t first_seed = 1;
  int num_threads = 1;
  /** Told after each run, by one thread at a time. */
  std::function<void(std::size_t num_done, std::size_t num_all)> report;
};

/** \brief Run what \p results does not have. A row does not depend on the number of
 * threads.
 * \throws io::FileError, and what samplers throw; rows of other runs are kept */
void
runRankStudy(const RankStudy& study, RankFile& results);

/** \brief The ranks of one sampler's good runs. */
std::vector<Ranks>
ranksOfSampler(const RankStudy& study,
               const RankSampler& sampler,
               const RankFile& results);

} // namespace bayesian_icp::evaluate
