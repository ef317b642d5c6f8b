/** \file
 * \brief The distribution of ICP's results over random starts: the baseline of the
 * paper's evaluation.
 */
#pragma once

#include <bayesian_icp/pose.h>

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace bayesian_icp::evaluate {

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
  /** To completion: more than ICP's default. Less than 1 is one iteration. */
  int max_iterations = 1000;
  /** Largest distance of corresponding points [m], inclusive. */
  double max_distance = std::numeric_limits<double>::infinity();
};

/** \brief What ended a run; the first that holds, in this order. */
enum class IcpStop {
  TooFewPairs,
  MaxIterations,
  /** An iteration did not move the source. */
  Transformation,
  /** The mean squared distance of the pairs changed by less than 1e-12 m^2. */
  AbsoluteFitness
};

inline constexpr std::array icp_stops = {IcpStop::TooFewPairs,
                                         IcpStop::MaxIterations,
                                         IcpStop::Transformation,
                                         IcpStop::AbsoluteFitness};

/** \brief Short name: "too_few_pairs", "max_iterations", "transformation",
 * "absolute_fitness". */
const char*
toString(IcpStop stop);

/** \brief One run. */
struct MonteCarloIcpRun {
  int index = 0;
  /** Poses (x, y, z, roll, pitch, yaw) [m, rad], the end canonical. */
  Vector6d start = Vector6d::Zero();
  Vector6d end = Vector6d::Zero();
  /** As pcl::Registration::hasConverged(): false only without enough pairs. Stopping at
   * max_iterations counts as converged there. */
  bool has_converged = false;
  IcpStop stop = IcpStop::TooFewPairs;
  /** Those that moved the source. */
  int num_iterations = 0;
  /** Of the pairs of the last iteration, before its step [m^2]; infinite if they were
   * too few. */
  double mean_squared_distance = std::numeric_limits<double>::infinity();
};

/** \brief Run ICP from random starts (Maken, Ramos, Ott 2020, section IV).
 * \param[in] source 3 x n, source frame [m]; starts are poses about its origin. Points
 *            that are not finite, or further out than 1e18 m, are left out
 * \param[in] target 3 x m, target frame [m], likewise
 * \param[in] options starts, ICP and threads
 * \return the runs in the order of their index */
std::vector<MonteCarloIcpRun>
monteCarloIcp(const Eigen::Matrix3Xd& source,
              const Eigen::Matrix3Xd& target,
              const MonteCarloIcpOptions& options);

} // namespace bayesian_icp::evaluate
