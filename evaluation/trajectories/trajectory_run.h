/** \file
 * \brief Trajectories that the same solver makes of the edges of several methods: how
 * far they are from the true ones, and whether their covariances say so.
 */
#pragma once

#include "graph/optimization.h"
#include "trajectories/registered_edge.h"

namespace bayesian_icp::evaluate {

/** \brief Errors of a trajectory whose first pose is known. ATE and RPE are those of
 * evo (evo_ape -a, evo_rpe --delta 1) and of Sturm et al. (IROS 2012). */
struct TrajectoryScore {
  /** Root mean square error of the positions after the rigid alignment of both
   * trajectories that makes it smallest [m]. */
  double ate = 0.0;
  /** Root mean squares over neighbours of the error of their relative pose: length of
   * its translation [m], and its angle [rad]. */
  double rpe_translation = 0.0;
  double rpe_rotation = 0.0;
  /** Error of the last pose in the frame of the first one: distance [m], angle [rad].
   */
  double drift_translation = 0.0;
  double drift_rotation = 0.0;
  /** Normalised squared error per degree of freedom, mean over all poses but the first
   * and of the last one; 1 if covariances are right. */
  double nees_per_degree = 0.0;
  double nees_per_degree_of_last = 0.0;
};

/** \brief Score a trajectory.
 * \param[in] estimate of at least two poses in the frame of the first one
 * \param[in] truth as many, in any frame
 * \param[in] truth_sd accuracy of relative poses of the truth, which the normalised
 * squared errors add to each covariance */
TrajectoryScore
scoreOf(const std::vector<app::GaussianPose>& estimate,
        const std::vector<Eigen::Isometry3d>& truth,
        const AxisDeviation& truth_sd = {});

/** \brief A recording and what its pairs have given, with every method. */
struct RegisteredRecording {
  Recording recording;
  std::uint64_t seed = 0;
  std::vector<EdgeRun> edges;
};

/** \brief A trajectory. */
struct TrajectoryRun {
  std::string recording, quality;
  std::uint64_t seed = 0;
  /** Methods of edge_methods from which means and covariances of the edges are;
   * covariances may be "constant". */
  std::string means, covariances;
  int num_scans = 0;
  /** Registrations that are of use. */
  int num_edges = 0;
  /** Without normalised squared errors (NaN) if the quality is C: the true poses are
   * of the same scans. */
  TrajectoryScore score;
  /** Closures of cycles of up to four edges, see closureOf(): their number, and the sum
   * of their squared errors over that of their degrees. */
  int num_cycles = 0;
  double cycle_nees_per_degree = 0.0;

  template <typename Column>
  void
  columns(const Column& column)
  {
    column("recording", recording);
    column("quality", quality);
    column("seed", seed);
    column("means", means);
    column("covariances", covariances);
    column("num_scans", num_scans);
    column("num_edges", num_edges);
    column("ate_m", score.ate);
    column("rpe_m", score.rpe_translation);
    column("rpe_rad", score.rpe_rotation);
    column("drift_m", score.drift_translation);
    column("drift_rad", score.drift_rotation);
    column("nees_per_degree", score.nees_per_degree);
    column("nees_per_degree_of_last", score.nees_per_degree_of_last);
    column("num_cycles", num_cycles);
    column("cycle_nees_per_degree", cycle_nees_per_degree);
  }
};

/** \brief All trajectories of all recordings, from registrations and from guessOf()
 * as an odometry from each scan to the next, which is the same for all: the means of
 * `calibrated` with each covariance, and those of each other method with its own;
 * `constant` also with the means of `gicp`.
 *
 * A constant covariance is that of one axis for translations and one for rotations: the
 * mean square of the errors of the edges that these means have in the other recordings
 * of the same kind, simulated or with poses of quality A and B. Without such edges
 * there is no trajectory of `constant`. */
std::vector<TrajectoryRun>
trajectoriesOf(const std::vector<RegisteredRecording>& recordings);

} // namespace bayesian_icp::evaluate
