/** \file
 * \brief Trajectories that the same solver makes of the edges of several methods.
 */
#pragma once

#include "graph/optimization.h"
#include "trajectories/registered_edge.h"
#include "trajectories/trajectory_score.h"

namespace bayesian_icp::evaluate {

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
  /** Methods of edgeMethods() from which means and covariances of the edges are;
   * covariances may be "constant". */
  std::string means, covariances;
  int num_scans = 0;
  /** Registrations that are of use. */
  int num_edges = 0;
  TrajectoryScore score;
  /** Closures of cycles of up to four edges, see closureOf(): their number, and the sum
   * of their squared errors over that of their degrees. */
  int num_cycles = 0;
  double cycle_nees = 0.0;

  template <typename Run, typename Column>
  static void
  columns(Run& run, const Column& column)
  {
    column("recording", run.recording);
    column("quality", run.quality);
    column("seed", run.seed);
    column("means", run.means);
    column("covariances", run.covariances);
    column("num_scans", run.num_scans);
    column("num_edges", run.num_edges);
    column("ate_m", run.score.ate);
    column("rpe_m", run.score.rpe_translation);
    column("rpe_rad", run.score.rpe_rotation);
    column("drift_m", run.score.drift_translation);
    column("drift_rad", run.score.drift_rotation);
    column("nees", run.score.nees);
    column("nees_of_last", run.score.nees_of_last);
    column("num_cycles", run.num_cycles);
    column("cycle_nees", run.cycle_nees);
  }
};

/** \brief All trajectories of all recordings, from registrations and from guessOf()
 * as an odometry from each scan to the next, which is the same for all: the means of
 * `calibrated` with each covariance, and those of each other method with its own;
 * `constant` also with the means of `gicp`.
 *
 * A constant covariance is that of one axis for translations and one for rotations: the
 * mean square of the errors of the edges that these means have in the other recordings
 * of the same kind, simulated or with poses of quality A and B. */
std::vector<TrajectoryRun>
trajectoriesOf(const std::vector<RegisteredRecording>& recordings,
               app::RobustLoss loss);

} // namespace bayesian_icp::evaluate
