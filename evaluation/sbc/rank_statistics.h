/** \file
 * \brief Simulation-based calibration: ranks of true poses among draws of their
 * posteriors, uniform if the sampler is right (Talts et al. 2018); and the CSV file
 * that keeps them.
 */
#pragma once

#include "study/run_file.h"

#include <bayesian_icp/prior.h>

#include <array>
#include <stdexcept>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Draws among which a truth is ranked, so that there are 100 ranks. */
constexpr int num_ranked_draws = 99;
constexpr int num_rank_bins = 10;
/** \brief What the chi-square statistic of num_rank_bins equally probable bins exceeds
 * with a probability of 0.1 %. */
constexpr double max_rank_chi_square = 27.9;
/** \brief With fewer, less than five are expected in a bin, and the statistic is not
 * chi-square. */
constexpr std::size_t min_ranked_runs = 5 * num_rank_bins;

/** \brief Rank of each coordinate, 0 ... num_ranked_draws. */
using Ranks = Eigen::Matrix<int, 6, 1>;

/** \brief Runs in each bin. */
using RankHistogram = std::array<int, num_rank_bins>;

/** \brief Rank of the truth among num_ranked_draws of the draws, evenly chosen so that
 * they are nearly independent. Coordinates are those of Prior::deviation(), angles
 * wrapped.
 * \param[in] draws one pose a row, at least num_ranked_draws, all finite */
Ranks
ranksOf(const Vector6d& true_pose, const PoseMatrix& draws, const Prior& prior);

/** \brief How often coordinate \p k has the ranks of each bin. */
RankHistogram
rankHistogram(const std::vector<Ranks>& runs, int k);

/** \brief Sum over the bins of (count - expected)^2 / expected; of at least one run. */
double
chiSquareOf(const RankHistogram& histogram);

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
  template <typename Column>
  void
  columns(const Column& column)
  {
    column("sampler", name.sampler);
    column("seed", name.seed);
    column("valid", is_valid);
    coordinateColumns("rank_", ranks, column);
    if (ranks.minCoeff() < 0 || ranks.maxCoeff() > num_ranked_draws)
      throw std::runtime_error("not a rank");
  }
};

using RankFile = RunFile<RankRun>;

} // namespace bayesian_icp::evaluate
