/** \file
 * \brief The runs of the paper's experiments, rows of a CSV file each.
 */
#pragma once

#include "coverage/coverage_score.h"
#include "paper/paper_baseline.h"
#include "samplers/score.h"
#include "study/run_file.h"

#include <cstdint>
#include <limits>
#include <string>

namespace bayesian_icp::evaluate {

/** \brief Which run of an experiment. */
struct PaperRunName {
  /** Hash of the clouds, and of the baseline if the run is compared with it: 16
   * hexadecimal digits. */
  std::string key;
  std::string pair;
  std::string method;
  std::uint64_t seed = 0;
  /** What else tells the runs of an experiment apart. */
  int number = 0;
};

/** \brief A run of a method against the baseline and the truth, behind Table I. Numbers
 * are NaN, or divergences infinite, where there are fewer than min_scored_draws. */
struct DistributionRun {
  static constexpr int num_name_columns = 4;

  PaperRunName name;
  /** KL(baseline || method) and the like [nats]; Wasserstein-1 in standard deviations
   * of the baseline. */
  Score score;
  /** KL(runs of the baseline in its main basin || method) [nats]; the first is NaN if
   * there are fewer than seven of those runs. */
  double main_kl = std::numeric_limits<double>::infinity();
  Vector6d main_coordinate_kl =
      Vector6d::Constant(std::numeric_limits<double>::infinity());
  /** Of the baseline's results and of the truth, in units of the prior's standard
   * deviations. */
  double energy_score = std::numeric_limits<double>::quiet_NaN();
  double truth_energy_score = std::numeric_limits<double>::quiet_NaN();
  /** Squared Mahalanobis distance of the truth. */
  double nees = std::numeric_limits<double>::quiet_NaN();
  /** Of the draws' mean: the source's centroid [m], and the rotation [rad]. */
  double translation_error = std::numeric_limits<double>::quiet_NaN();
  double rotation_error = std::numeric_limits<double>::quiet_NaN();
  /** Of the draws, angles unwrapped about the baseline's mean [m, rad]. */
  Vector6d mean = unknownVector();
  Vector6d standard_deviation = unknownVector();

  template <typename Column>
  void
  columns(const Column& column)
  {
    column("key", name.key);
    column("pair", name.pair);
    column("method", name.method);
    column("seed", name.seed);
    column("status", score.status);
    score.columns(column);
    column("main_kl", main_kl);
    coordinateColumns("main_kl_", main_coordinate_kl, column);
    column("energy_score", energy_score);
    column("truth_energy_score", truth_energy_score);
    column("nees", nees);
    column("translation_error_m", translation_error);
    column("rotation_error_rad", rotation_error);
    unitColumns("mean_", mean, column);
    unitColumns("sd_", standard_deviation, column);
  }
};

/** \brief KL(baseline || draws) [nats]: x, y, z, roll, pitch, yaw, and in 6-D. */
using CurveDivergences = Eigen::Matrix<double, 7, 1>;

/** \brief One run at one value of the axis of a curve; its method is a variant, its
 * number the value. */
struct CurvePoint {
  static constexpr int num_name_columns = 5;

  PaperRunName name;
  CurveDivergences divergences = CurveDivergences::Zero();

  template <typename Column>
  void
  columns(const Column& column)
  {
    column("key", name.key);
    column("pair", name.pair);
    column("variant", name.method);
    column("seed", name.seed);
    column("value", name.number);
    coordinateColumns("kl_", divergences, column);
    column("kl", divergences[6]);
  }
};

/** \brief The time of a run; its number is that of the threads. */
struct RuntimeRun {
  static constexpr int num_name_columns = 5;

  PaperRunName name;
  double wall_seconds = 0.0;
  /** Of all threads. */
  double cpu_seconds = 0.0;
  std::string status;

  template <typename Column>
  void
  columns(const Column& column)
  {
    column("key", name.key);
    column("pair", name.pair);
    column("method", name.method);
    column("threads", name.number);
    column("seed", name.seed);
    column("wall_s_per_1000_draws", wall_seconds);
    column("cpu_s_per_1000_draws", cpu_seconds);
    column("status", status);
  }
};

/** \brief Errors of the pose that is found from a start, which is a function of the
 * seed and the name's number. */
struct AccuracyRun {
  static constexpr int num_name_columns = 5;

  PaperRunName name;
  /** Euclidean [m]. */
  double translation_error = 0.0;
  /** Sum of the absolute differences of roll, pitch and yaw [rad]. */
  double rotation_error = 0.0;
  std::string status;

  template <typename Column>
  void
  columns(const Column& column)
  {
    column("key", name.key);
    column("pair", name.pair);
    column("method", name.method);
    column("seed", name.seed);
    column("start", name.number);
    column("translation_error_m", translation_error);
    column("rotation_error_rad", rotation_error);
    column("status", status);
  }
};

/** \brief Distance of a run's draws to the baseline and to the truth.
 * \param[in] name goes into the result */
DistributionRun
distributionRunOf(const PaperRunName& name,
                  const ScanPair& pair,
                  const SamplerRun& run,
                  const PaperBaseline& baseline);

/** \brief Draws of every chain: from row \p first on, \p count of them, both as totals
 * over all chains. */
struct DrawPart {
  int first = 0;
  int count = 0;
};

/** \brief Rows of the chains that did not diverge; what they do not have is left out.
 */
PoseMatrix
partOf(const ChainSet& chains, const DrawPart& part);

/** \brief KL(baseline || draws); infinite with fewer than min_scored_draws. */
CurveDivergences
curveDivergences(const PoseMatrix& draws, const PaperBaseline& baseline);

} // namespace bayesian_icp::evaluate
