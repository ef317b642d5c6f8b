/** \file
 * \brief The runs behind Table I and the CSV file that keeps them.
 */
#pragma once

#include "run_file.h"
#include "samplers/score.h"

#include <cstdint>
#include <string>
#include <tuple>

namespace bayesian_icp::evaluate {

/** \brief A run of a method against the baseline and the truth. Numbers are NaN, or
 * divergences infinite, where there are fewer than 10 draws. */
struct DistributionRun {
  struct Name {
    /** Hash of clouds and baseline, 16 hexadecimal digits. */
    std::string key;
    std::string pair;
    std::string method;
    std::uint64_t seed = 0;

    bool
    operator<(const Name& other) const
    {
      return std::tie(key, pair, method, seed) <
             std::tie(other.key, other.pair, other.method, other.seed);
    }
  };

  Name name;
  /** KL(baseline || method) and the like [nats]; Wasserstein-1 in standard deviations
   * of the baseline. */
  Score score;
  /** KL(runs of the baseline in its main basin || method) [nats]; the first is NaN if
   * there are fewer than seven of those runs. */
  double main_kl = 0.0;
  Vector6d main_coordinate_kl = Vector6d::Zero();
  /** Of the baseline's results and of the truth, in units of the prior's standard
   * deviations. */
  double energy_score = 0.0;
  double truth_energy_score = 0.0;
  /** Squared Mahalanobis distance of the truth. */
  double nees = 0.0;
  /** Of the draws' mean: the source's centroid [m], and the rotation [rad]. */
  double translation_error = 0.0;
  double rotation_error = 0.0;
  /** Of the draws, angles unwrapped about the baseline's mean [m, rad]. */
  Vector6d mean = Vector6d::Zero();
  Vector6d standard_deviation = Vector6d::Zero();

  static std::string
  header();

  std::string
  row() const;

  /** \throws std::exception if the line is not a row */
  static DistributionRun
  ofRow(const std::string& line);
};

using DistributionFile = RunFile<DistributionRun>;

} // namespace bayesian_icp::evaluate
