/** \file
 * \brief What is measured of a sampler's run, and where it is kept: a CSV file that
 * grows by a row a run, so that an interrupted study goes on where it stopped.
 */
#pragma once

#include "row_file.h"
#include "samplers/sampler_runs.h"

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
  /** Hash of inputs and options of the gold standard. */
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
};

/** \brief Names of the numbers of a score in a CSV file, and a visit to each in that
 * order. */
constexpr char score_columns[] =
    "kl,kl_x,kl_y,kl_z,kl_roll,kl_pitch,kl_yaw,w1_x,w1_y,w1_z,w1_roll,w1_pitch,w1_yaw,"
    "ks_x,ks_y,ks_z,ks_roll,ks_pitch,ks_yaw,rhat,bulk_ess,tail_ess,seconds,draws";

template <typename ScoreType, typename Visit>
void
forEachNumber(ScoreType& score, const Visit& visit)
{
  visit(score.kl);
  for (auto* vector :
       {&score.coordinate_kl, &score.wasserstein, &score.kolmogorov_smirnov})
    for (int k = 0; k < 6; ++k)
      visit((*vector)[k]);
  visit(score.rhat);
  visit(score.bulk_ess);
  visit(score.tail_ess);
  visit(score.seconds);
  visit(score.num_draws);
}

struct ScoredRun {
  RunName name;
  Score score;
};

/** \brief With fewer draws there are no distances. */
constexpr Eigen::Index min_scored_draws = 10;

/** \param[in] gold_draws poses theta of the gold standard */
Score
scoreOf(const SamplerRun& run, const PoseMatrix& gold_draws);

/** \brief The CSV file of a study. */
class ResultFile {
public:
  /** \brief Read what is there; a last line that was cut off is dropped.
   * \throws io::FileError if the file exists and is not of this format, or cannot be
   *         written */
  explicit ResultFile(const std::string& name);

  /** \brief The run of this name, or null. */
  const ScoredRun*
  find(const RunName& name) const;

  /** \brief Write a row, at once.
   * \throws io::FileError */
  void
  add(const ScoredRun& run);

  const std::vector<ScoredRun>&
  runs() const
  {
    return runs_;
  }

private:
  std::vector<ScoredRun> runs_;
  RowFile file_;
};

} // namespace bayesian_icp::evaluate
