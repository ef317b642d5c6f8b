/** \file
 * \brief The distribution of ICP's results over random starts: the baseline of the
 * paper's evaluation.
 */
#pragma once

#include "baselines/iterative_closest_point.h"

#include <bayesian_icp/pose.h>

#include <cstdint>
#include <limits>
#include <vector>

namespace bayesian_icp {

/** \brief Where the runs start, and when each stops. */
struct MonteCarloIcpOptions {
  /** Starts are uniform in mean +- half_range [m, rad], coordinate by coordinate. */
  Vector6d mean = Vector6d::Zero();
  Vector6d half_range = Vector6d::Ones();
  /** Runs first_run ... first_run + num_runs - 1 (below 2^31 - 1): run k is a function
   * of (seed, k) alone, so that a part of the runs can be made later. */
  int first_run = 0;
  int num_runs = 10000;
  std::uint64_t seed = 1;
  /** 0: as OpenMP would. Results do not depend on it. */
  int num_threads = 0;
  /** To completion: more iterations than ICP's default. */
  IcpOptions icp = {1000};
};

/** \brief One run. */
struct MonteCarloIcpRun {
  int index = 0;
  /** Poses (x, y, z, roll, pitch, yaw) [m, rad], the end canonical. */
  Vector6d start = Vector6d::Zero();
  Vector6d end = Vector6d::Zero();
  /** What follows is as in IcpResult. */
  bool has_converged = false;
  IcpStop stop = IcpStop::TooFewPairs;
  int num_iterations = 0;
  /** Of the pairs of the last iteration, before its step [m^2]. */
  double mean_squared_distance = std::numeric_limits<double>::infinity();
};

/** \brief Run ICP from random starts (Maken, Ramos, Ott 2020, section IV).
 * \param[in] source 3 x n, finite, source frame [m]; starts are poses about the origin
 *            of that frame
 * \param[in] target points, target frame [m]
 * \param[in] options starts, ICP and threads
 * \return the runs in the order of their index */
std::vector<MonteCarloIcpRun>
monteCarloIcp(const Eigen::Matrix3Xd& source,
              const KdTree& target,
              const MonteCarloIcpOptions& options);

} // namespace bayesian_icp
