/** \file
 * \brief One short run of each method on the same clouds, whose numbers are compared
 * over threads, instruction sets, builds and versions of the library.
 */
#pragma once

#include <bayesian_icp/pipeline.h>

#include <cstdint>
#include <string>
#include <vector>

namespace bayesian_icp::test {

/** Points of a wavy surface of 1 x 0.6 m with noise of 3 mm. Sums and products only,
 * which every machine rounds alike; sin() it may not. */
Eigen::Matrix3Xd
wavySurface(std::uint64_t seed, Eigen::Index num_points);

/** How a run is made. None of it may change what comes out, rounding apart. */
struct RunSettings {
  int num_threads = 1;
  /** Move each coordinate of the source to the next double, up or down at random. */
  bool is_nudged = false;
};

/** Rows of poses (x, y, z, roll, pitch, yaw) [m, rad] that belong together. */
struct PoseTable {
  std::string name;
  PoseMatrix rows;
};

/** What came out of a run. */
struct RunRecord {
  /** The status in a word, or for many runs their ends. */
  std::string outcome;
  /** What a difference between poses is measured in: the standard deviation of the
   * posterior; a millimetre and a milliradian where there is none. */
  Vector6d unit = Vector6d::Constant(1e-3);
  std::vector<PoseTable> tables;
  /** What is compared between runs of one build only: all covariances and diagnostics.
   */
  std::vector<double> numbers;
};

/** The record of an estimate: mean, standard deviations, covariance, draws. */
RunRecord
recordOf(const PosteriorEstimate& estimate);

/** Largest difference between two records in units of the first one; infinite if they
 * are not of the same kind, or one has a number where the other has none. */
double
difference(const RunRecord& a, const RunRecord& b);

/** Whether two records agree to the last bit. */
bool
areIdentical(const RunRecord& a, const RunRecord& b);

/** Names of all runs. */
std::vector<std::string>
runNames();

/** Make one of the runs. */
RunRecord
makeRun(const std::string& name, const RunSettings& settings = RunSettings());

/** Difference, in units of a record, that is put down to rounding: other processors,
 * compilers and optimisation give less (docs/packaging.md says how much), another
 * algorithm far more. */
constexpr double rounding_tolerance = 1e-6;

} // namespace bayesian_icp::test
