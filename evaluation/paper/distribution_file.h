/** \file
 * \brief The runs behind Table I and the CSV file that keeps them.
 */
#pragma once

#include "samplers/score.h"
#include "study/run_file.h"

#include <cstdint>
#include <string>

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

    template <typename Self, typename Column>
    static void
    columns(Self& self, const Column& column)
    {
      column("key", self.key);
      column("pair", self.pair);
      column("method", self.method);
      column("seed", self.seed);
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

  template <typename Self, typename Column>
  static void
  columns(Self& self, const Column& column)
  {
    Name::columns(self.name, column);
    column("status", self.score.status);
    Score::columns(self.score, column);
    column("main_kl", self.main_kl);
    coordinateColumns("main_kl_", self.main_coordinate_kl, column);
    column("energy_score", self.energy_score);
    column("truth_energy_score", self.truth_energy_score);
    column("nees", self.nees);
    column("translation_error_m", self.translation_error);
    column("rotation_error_rad", self.rotation_error);
    for (std::size_t k = 0; k < 6; ++k)
      column("mean_" + app::coordinateKey(k), self.mean[Eigen::Index(k)]);
    for (std::size_t k = 0; k < 6; ++k)
      column("sd_" + app::coordinateKey(k), self.standard_deviation[Eigen::Index(k)]);
  }
};

using DistributionFile = RunFile<DistributionRun>;

} // namespace bayesian_icp::evaluate
