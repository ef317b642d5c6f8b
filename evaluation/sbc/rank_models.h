/** \file
 * \brief Models whose posterior is the samplers' very target: a true pose drawn from
 * the prior, and data drawn from the likelihood.
 */
#pragma once

#include "calibrated/draws/calibrated_draws.h"

#include <bayesian_icp/random.h>

namespace bayesian_icp::evaluate {

/** \brief A pose drawn from \p prior, whose variances are finite: a Gaussian position
 * of the reference point and von Mises angles. */
Vector6d
drawFrom(const Prior& prior, Random& random);

/** \brief The model of preset `exact`, point to point.
 *
 * Target points are so far from each other that every source point's neighbour is the
 * right one for all poses that the prior allows. Source points are the target's moved
 * by the inverse of the true pose, each with isotropic noise: the likelihood with
 * N = number of points, normalised alike for all poses. */
struct FarPointsModel {
  explicit FarPointsModel(Random& random);

  Prior prior;
  /** (x, y, z, roll, pitch, yaw) [m, rad]. */
  Vector6d truth;
  /** 3 x n [m]. */
  Eigen::Matrix3Xd source;
  Eigen::Matrix3Xd target;
  /** Standard deviation of each source coordinate [m]. */
  double noise;
};

/** \brief The model of preset `calibrated`: scores that are linear in the coordinates
 * of ProductCoordinates, with the covariance J that the estimate states.
 *
 * The estimate is linearised at the prior's mean, whatever the data. Scores of single
 * points have errors that cancel in the total, so that mini-batches are noisy. */
struct LinearScoreModel {
  /** \param[in] is_yaw_free no point measures the yaw, whose prior is wide */
  LinearScoreModel(bool is_yaw_free, Random& random);

  /** \brief Scores of batches; this object must outlive it. */
  BatchScore
  score() const;

  Prior prior;
  /** (x, y, z, roll, pitch, yaw) [m, rad]. */
  Vector6d truth;
  CalibratedEstimate estimate;

private:
  /** Directions, H and J, before any data. */
  void
  setInformation(bool is_yaw_free, Random& random);

  /** Total score and those of the points, given the truth. */
  void
  drawScores(Random& random);

  /** What the residual of a point changes by away from the mode. */
  Eigen::VectorXd errors_;
};

} // namespace bayesian_icp::evaluate
