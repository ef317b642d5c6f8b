/** \file
 * \brief What is measured of a sampler's run, and where it is kept: a CSV file that
 * grows by one row per run, so an interrupted study continues where it stopped.
 */
#pragma once

#include "samplers/sampler_runs.h"
#include "study/run_file.h"

#include <bayesian_icp/options.h>
#include <bayesian_icp/summary.h>

#include <cstdint>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Which run. */
struct RunName {
  std::string scene;
  double sigma = 0.0;
  double effective_points = 0.0;
  /** For example "exact" or "paper 1e-05". */
  std::string sampler;
  std::uint64_t seed = 0;
  /** See rowKey(). */
  std::string gold_key;
};

/** \brief Distance of the draws to the gold standard, and their diagnostics. */
struct Score {
  /** KL(gold || draws) of Gaussian moments, 6-D and per coordinate x, y, z, roll,
   * pitch, yaw [nats]; infinite without enough draws. */
  double kl = 0.0;
  Vector6d coordinate_kl = Vector6d::Zero();
  /** Of the marginals; Wasserstein-1 in standard deviations of the gold standard. */
  Vector6d wasserstein = Vector6d::Zero();
  Vector6d kolmogorov_smirnov = Vector6d::Zero();
  /** Largest R-hat, smallest bulk and tail ESS of a coordinate. */
  double rhat = 0.0;
  double bulk_ess = 0.0;
  double tail_ess = 0.0;
  double seconds = 0.0;
  double num_draws = 0.0;
  /** Short name of the Status. */
  std::string status;

  /** \brief Smallest bulk ESS a second of CPU time. */
  double
  essPerSecond() const
  {
    return bulk_ess / seconds;
  }

  /** \brief All but the status. */
  template <typename Column>
  void
  columns(const Column& column)
  {
    column("kl", kl);
    coordinateColumns("kl_", coordinate_kl, column);
    coordinateColumns("w1_", wasserstein, column);
    coordinateColumns("ks_", kolmogorov_smirnov, column);
    column("rhat", rhat);
    column("bulk_ess", bulk_ess);
    column("tail_ess", tail_ess);
    column("seconds", seconds);
    column("draws", num_draws);
  }
};

/** \brief A run of a sampler. */
struct ScoredRun {
  static constexpr int num_name_columns = 6;

  RunName name;
  Score score;

  template <typename Column>
  void
  columns(const Column& column)
  {
    column("gold_key", name.gold_key);
    column("scene", name.scene);
    column("sigma", name.sigma);
    column("effective_points", name.effective_points);
    column("sampler", name.sampler);
    column("seed", name.seed);
    column("status", score.status);
    score.columns(column);
    auto ess_per_second = score.essPerSecond();
    column("min_ess_per_second", ess_per_second);
  }
};

/** \brief With fewer draws there are no distances. */
constexpr Eigen::Index min_scored_draws = min_particles;

/** \param[in] gold_draws poses theta of the gold standard */
Score
scoreOf(const SamplerRun& run, const PoseMatrix& gold_draws);

using ResultFile = RunFile<ScoredRun>;

/** \brief A table of medians and worst cases of each sampler on each problem. */
std::string
summaryOf(const std::vector<ScoredRun>& runs);

} // namespace bayesian_icp::evaluate
