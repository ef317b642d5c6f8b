/** \file
 * \brief Simulation-based calibration: ranks of true poses among draws of their
 * posteriors, uniform if the sampler is right (Talts et al. 2018); the samplers, and
 * the CSV file that keeps their ranks.
 */
#pragma once

#include "study/run_file.h"

#include <bayesian_icp/prior.h>

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
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

/** \brief Rank of the truth among num_ranked_draws of the draws, evenly chosen so that
 * they are nearly independent. Coordinates are those of Prior::deviation(), angles
 * wrapped.
 * \param[in] draws one pose a row, at least num_ranked_draws, all finite */
Ranks
ranksOf(const Vector6d& true_pose, const PoseMatrix& draws, const Prior& prior);

/** \brief Chi-square statistic of the ranks that coordinate \p k has: the sum over the
 * bins of (count - expected)^2 / expected; of at least one run. */
double
chiSquareOf(const std::vector<Ranks>& runs, int k);

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

/** \brief A sampler and the model that it is given. */
struct RankSampler {
  std::string name;
  /** Whether the data are drawn from the very likelihood, so that ranks have to be
   * uniform. */
  bool is_well_specified;
  /** One run: true pose, data, draws, ranks; nothing if the draws are no good. Uses one
   * thread, is called by several at once, and depends on the seed only. */
  std::function<std::optional<Ranks>(std::uint64_t seed)> run;
};

/** \brief All of them:
 *
 * - exact-langevin, exact-metropolis: preset `exact` on FarPointsModel.
 * - calibrated: sampleCalibrated() on LinearScoreModel, with a free yaw in every other
 *   run.
 * - calibrated-scans: preset `calibrated` on simulated scans of the tuned scenes, same
 *   view; not a well-specified model. */
std::vector<RankSampler>
rankSamplers();

/** \brief What the ranks of some runs say. */
struct RankVerdict {
  /** A line for each sampler: runs, chi-square statistic of each coordinate, verdict;
   * below a header. */
  std::vector<std::vector<std::string>> rows;
  /** Whether every well-specified sampler has uniform ranks: all runs good and, of at
   * least min_ranked_runs, every statistic below max_rank_chi_square. */
  bool are_uniform = true;
};

RankVerdict
verdictOf(const std::vector<RankRun>& runs);

} // namespace bayesian_icp::evaluate
