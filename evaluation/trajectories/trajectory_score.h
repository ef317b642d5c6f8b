/** \file
 * \brief How far an estimated trajectory is from the true one, and whether its
 * covariances say so.
 */
#pragma once

#include "graph/pose_graph.h"

#include <Eigen/Geometry>

#include <vector>

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
  double nees = 0.0;
  double nees_of_last = 0.0;
};

/** \brief Score a trajectory.
 * \param[in] estimate of at least two poses in the frame of the first one
 * \param[in] truth as many, in any frame */
TrajectoryScore
scoreOf(const std::vector<app::GaussianPose>& estimate,
        const std::vector<Eigen::Isometry3d>& truth);

} // namespace bayesian_icp::evaluate
