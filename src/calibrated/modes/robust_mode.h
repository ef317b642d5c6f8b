/** \file
 * \brief Search for the mode of robust surface likelihood times prior by re-weighted
 * least squares.
 */
#pragma once

#include "calibrated/score/surface_score.h"
#include "geometry/twist.h"

namespace bayesian_icp {

/** \brief Options of a fit. */
struct RobustFitOptions {
  /** Scale tau of Tukey's weight at the start, in units of the target's noise. It falls
   * to the scale of the residuals. 0 starts at that scale. */
  double start_scale = 0.0;
  /** Maximum number of steps. Each step searches all correspondences again. */
  int max_steps = 25;
  /** The fit has converged if a step moves the source by less than this root mean
   * squared displacement [m]. */
  double tolerance = 0.0;
  /** Precision that holds the pose at the start, for twists about the moved source's
   * centroid, translation [m] first. */
  Matrix6d hold = Matrix6d::Zero();
};

/** \brief Result of a fit. */
struct RobustFit {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  /** residualScale() at the end. */
  double residual_scale = 1.0;
  /** cappedResiduals() and costOf() at the end. */
  Eigen::VectorXd residuals;
  double cost = 0.0;
};

/** \brief Fit by iteratively re-weighted least squares of the distances to the surface,
 * with annealing, from \p start. Points have a fifth of their weight against the prior,
 * because they are correlated. */
RobustFit
fitRobustly(const SurfaceScorer& scorer,
            const HeldPrior& prior,
            const Eigen::Isometry3d& start,
            const RobustFitOptions& options);

/** \brief How well a pose fits: the fit that stays there. */
RobustFit
fitAt(const SurfaceScorer& scorer,
      const HeldPrior& prior,
      const Eigen::Isometry3d& pose);

/** \brief Cost of \p a in units of the cost of \p b, two fits of the same points.
 *
 * Only the points that have a patch at both are compared, if these distinguish the fits
 * by two standard deviations of the difference. More points with a patch only show that
 * the target was seen there: two views of a wall overlap most where the sensor has not
 * moved. If the common points do not distinguish the fits, all points are compared, and
 * a point without a patch counts as one that does not fit, unless it is on the
 * continuation of the target's surface. */
double
relativeCost(const RobustFit& a, const RobustFit& b);

/** \brief Whether \p a costs more than \p b on all points, and at least (1 + \p margin)
 * times as much by relativeCost(). Both are needed: \p b must not be the better one
 * because it meets less of the target. */
bool
isClearlyWorse(const RobustFit& a, const RobustFit& b, double margin);

/** \brief Point-to-point ICP from \p start to the points of the model, where the prior
 * has little weight. */
RobustFit
fitPointToPoint(const SurfaceScorer& scorer,
                const HeldPrior& prior,
                const Eigen::Isometry3d& start);

/** \brief D of the source about its centroid at a pose: the mean squared displacement
 * of its points by a twist xi about the moved centroid is xi^T D xi [m^2]. */
Matrix6d
displacementMetric(const SurfaceScorer& scorer,
                   const Eigen::Isometry3d& T_target_source);

} // namespace bayesian_icp
