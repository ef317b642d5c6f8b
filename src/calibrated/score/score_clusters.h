/** \file
 * \brief Covariance of a sum of scores whose points are correlated in space.
 */
#pragma once

#include "calibrated/score/surface_score.h"

namespace bayesian_icp {

/** \brief How points are grouped. */
struct ClusterOptions {
  /** Approximate number of clusters. */
  int num_clusters = 48;
  /** Random partitions over which the result is averaged. */
  int num_partitions = 8;
  /** Stream of the random partitions. */
  std::uint64_t stream = 0;
  /** Whether clusters are shells about the origin of the source's frame. */
  bool are_shells = false;
};

/** \brief Scores and positions of points. */
struct PointScores {
  /** One active point per column [1/m, 1/rad]. */
  Matrix6Xd scores;
  /** One column per point. Its outer product is the Gauss-Newton information of the
   * point. Empty if the pose was not fitted to these scores. */
  Matrix6Xd jacobians;
  /** Source frame [m]. */
  Eigen::Matrix3Xd positions;
};

/** \brief The active points of \p scores. */
PointScores
activeScores(const SurfaceScores& scores, const Eigen::Matrix3Xd& source_points);

/** \brief Covariance of the total score under the assumption that clusters of
 * neighbouring points are independent of each other: the sum of outer products of the
 * clusters' total scores.
 *
 * Clusters are the leaves of randomised kd-splits, or shells, with about equal numbers
 * of points. Scores at a fitted pose are too small. Therefore the score of cluster b,
 * whose Gauss-Newton information is H_b, is multiplied by (I - H_b H_w^-1)^-1/2, the
 * whitened form of CR2 (Bell and McCaffrey 2002). Without jacobians, the sum over L
 * clusters is multiplied by L / (L - 1).
 * \param[in] points their scores and positions
 * \param[in] working_information H_w: information of points and prior in the fit
 * \param[in] options number of clusters, and of partitions to average over */
Matrix6d
clusteredCovariance(const PointScores& points,
                    const Matrix6d& working_information,
                    const ClusterOptions& options);

/** \brief Covariance J of the total score at a fitted pose. */
struct ScoreCovariance {
  Matrix6d covariance = Matrix6d::Zero();
  /** Ratio of the covariance of about 48 clusters to that of independent points. */
  double kappa_48 = 1.0;
  /** The same ratio, extrapolated to clusters so large that they are independent; at
   * least 1. */
  double kappa_inf = 1.0;
  /** The ratio that J has: kappa_inf, or that of shells if it is clearly larger. */
  double kappa = 1.0;
};

/** \brief Estimate J.
 *
 * Half of J has the shape of the covariance of 48 clusters, half that of independent
 * points. Both are scaled by ScoreCovariance::kappa. The factor nu / (nu - 13) corrects
 * for the finite number nu = n / kappa of independent points from which J is estimated.
 *
 * \param[in] points their scores and positions
 * \param[in] fit_precision tau^2 P, the precision of the prior in units of the scores
 */
ScoreCovariance
scoreCovariance(const PointScores& points,
                const Matrix6d& fit_precision,
                int num_threads = 1);

} // namespace bayesian_icp
