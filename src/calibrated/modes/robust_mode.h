/** \file
 * \brief The mode of robust surface likelihood times prior, by re-weighted least
 * squares.
 */
#pragma once

#include "calibrated/score/surface_score.h"
#include "geometry/twist.h"

namespace bayesian_icp {

/** \brief How a mode is approached. */
struct RobustFitOptions {
  /** Scale tau of Tukey's weight at the start, in units of the target's noise. It is
   * reduced to the scale of the residuals. 0 starts at that scale. */
  double start_scale = 0.0;
  /** Most steps; each one searches all correspondences again. */
  int max_steps = 25;
  /** Root mean squared displacement of the source at which it has converged [m]. */
  double tolerance = 0.0;
  /** Precision with which the start holds the pose, in a twist about the source's
   * centroid, translation [m] first. */
  Matrix6d hold = Matrix6d::Zero();
};

/** \brief Where a fit ended. */
struct RobustFit {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  /** residualScale() there. */
  double residual_scale = 1.0;
  /** cappedResiduals() and costOf() there. */
  Eigen::VectorXd residuals;
  double cost = 0.0;
  /** Evaluations of all points. */
  int num_evaluations = 0;
};

/** \brief Iteratively re-weighted least squares of the distances to the surface, from
 * \p start, annealed. Points have a fifth of their weight against the prior, because
 * they are correlated. */
RobustFit
fitRobustly(const SurfaceScorer& scorer,
            const Prior& prior,
            const Eigen::Isometry3d& start,
            const RobustFitOptions& options);

/** \brief Cost of \p a in units of the cost of \p b, two fits of the same points.
 *
 * Only the points that have a patch at both are compared, if these tell the fits apart
 * (by two standard deviations of the difference). That more points have a patch only
 * says that the target was seen there: two views of a wall overlap most where the
 * sensor has not moved. If these points do not tell, all points are compared, and a
 * point without a patch counts as one that does not fit, unless it is on the surface
 * that continues the target's. */
double
relativeCost(const RobustFit& a, const RobustFit& b);

/** \brief Whether \p a costs more than \p b on all points, and at least (1 + \p margin)
 * times as much by relativeCost(): that \p b meets less of the target must not make it
 * the better one. */
bool
isClearlyWorse(const RobustFit& a, const RobustFit& b, double margin);

/** \brief Point-to-point ICP on the model's points from \p start, with a weak prior. */
RobustFit
fitPointToPoint(const SurfaceScorer& scorer,
                const Prior& prior,
                const Eigen::Isometry3d& start);

/** \brief D of the source about its centroid at a pose: the mean squared displacement
 * of its points by a twist xi about the moved centroid is xi^T D xi [m^2]. */
Matrix6d
displacementMetric(const SurfaceScorer& scorer,
                   const Eigen::Isometry3d& T_target_source);

} // namespace bayesian_icp
