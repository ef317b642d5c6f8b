/** \file
 * \brief The calibrated Gaussian: mode, score covariance, curvature, and the posterior
 * that follows from them.
 */
#pragma once

#include "calibrated/score/surface_score.h"
#include "calibrated/surface/prepared_surface.h"
#include "calibrated/surface/relative_size.h"
#include "geometry/twist.h"

#include <cstdint>

namespace bayesian_icp {

/** \brief Information of the data about the pose at one mode. Twists are about centre,
 * in the target frame [m, rad]. docs/calibration.md has the formulas. */
struct CalibratedEstimate {
  /** Mode of the robust surface likelihood times the prior. */
  Eigen::Isometry3d mode = Eigen::Isometry3d::Identity();
  /** The moved source's centroid at the mode, target frame [m]. */
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  /** tau: robust scale of the residuals at the mode, in units of the target's noise. */
  double residual_scale = 1.0;
  /** Scores at the mode. */
  SurfaceScores scores;
  /** J: covariance of the total score. */
  Matrix6d score_covariance = Matrix6d::Zero();
  /** H: curvature of the total score with new correspondences, symmetric. */
  Matrix6d curvature = Matrix6d::Zero();
  /** D: the mean squared displacement of the source's points by a twist xi is xi^T D xi
   * [m^2]. */
  Matrix6d displacement_metric = Matrix6d::Identity();
  /** V: columns are the twists along which the curvature was measured, scaled to unit
   * root mean squared displacement. */
  Matrix6d directions = Matrix6d::Identity();
  /** Share of the information along each direction that is above its noise, in [0, 1].
   * 0 means that the prior alone holds the direction. */
  Vector6d keep = Vector6d::Zero();
  /** T = V diag(sqrt(keep)) V^-1. */
  Matrix6d transfer = Matrix6d::Zero();
  /** Lambda = T^T H J^-1 H T. */
  Matrix6d information = Matrix6d::Zero();
  TwistPrior prior;
  /** Sigma = (Lambda + P)^-1. */
  Matrix6d covariance = Matrix6d::Identity();
  /** Twist from the mode to the posterior mean. */
  Vector6d mean = Vector6d::Zero();
  /** nu: degrees of freedom. Along the directions that the data hold, the posterior is
   * Student's t with the covariance above, because the information is itself an
   * estimate. nu is at least 3, or 0 for a Gaussian. */
  int degrees_of_freedom = 0;
  /** Ratio of the score's covariance to that of independent points: for clusters of
   * about 1/48 of the points, and extrapolated to clusters that are independent. */
  double kappa_48 = 1.0;
  double kappa_inf = 1.0;
  /** meanCappedResidual() at the mode. */
  double cost = 0.0;
  /** Twist from the better end of the two starts to the worse one; zero if both ended
   * in one place. */
  Vector6d other_end = Vector6d::Zero();
  /** relativeCost() of the worse end of the two starts, in units of the better one; at
   * least 1. */
  double other_cost_ratio = 1.0;
  /** Squared distance from the prior's mean, in standard deviations of the prior, of a
   * pose at which the clouds meet clearly better than at the mode. 0 if none was found
   * or looked for. */
  double better_fit = 0.0;
};

/** \brief Numbers of points and rounds of the estimate. */
struct EstimateOptions {
  /** Number of source points on which the starts are followed. */
  int num_mode_points = 500;
  /** Number of source points with which the ends of the starts are compared, and number
   * of points of both clouds with which the curvature is measured. The score and its
   * covariance use all points. */
  int num_curvature_points = 2000;
  /** Rounds of measuring the curvature. */
  int num_rounds = 3;
  /** 0: as OpenMP would. No result depends on it. */
  int num_threads = 1;
};

/** \brief The points of a cloud that the estimate uses. They cover the cloud evenly,
 * because near the sensor most points repeat each other, and far points hold rotations.
 * The first EstimateOptions::num_curvature_points cover it evenly by themselves. Up to
 * a fifth as many pointsFacingRareMotions() come on top, everywhere in the order.
 *
 * \param[in] points 3 x n [m]
 * \param[in] used columns to choose from, finite
 * \param[in] own surface of the points
 * \param[in] other surface of the other cloud
 * \param[in] max_points maximum number of even points. More than 250 are at most one
 *            per patch, and more than num_curvature_points at most 40 % of the points
 *            and 0.4 per patch.
 * \param[in] seed of their order. The order is random, so that the search for the mode,
 *            which uses the first points, gets a random choice. */
Eigen::Matrix3Xd
evenPoints(const Eigen::Matrix3Xd& points,
           const std::vector<Eigen::Index>& used,
           const SurfaceModel& own,
           const SurfaceModel& other,
           Eigen::Index max_points,
           std::uint64_t seed);

/** \brief Scorer of evenPoints() of each cloud against the surface of the other, of
 * those that PreparedSurface::columns names. If the source has no usable surface, or if
 * it alone lies in a plane, only source points are compared, with the target's surface.
 *
 * \param[in] source_points 3 x n [m]
 * \param[in] source surface of these; must outlive the scorer
 * \param[in] target_points 3 x m [m]
 * \param[in] target surface of these; must outlive the scorer
 * \param[in] max_points maximum number of points of each cloud
 * \param[in] seed of their order
 * \param[in] num_threads of the choice and of the scorer; 0: as OpenMP would. No result
 *            depends on it.
 * \param[in] reach of the source: target points beyond it are not compared */
SurfaceScorer
scorerOf(const Eigen::Matrix3Xd& source_points,
         const PreparedSurface& source,
         const Eigen::Matrix3Xd& target_points,
         const PreparedSurface& target,
         Eigen::Index max_points,
         std::uint64_t seed,
         int num_threads = 1,
         const Reach& reach = Reach());

/** \brief Find the mode from two starts (the prior's mean, and the result of
 * point-to-point ICP from there) and estimate the posterior covariance.
 * \param[in] scorer of both clouds
 * \param[in] prior whose mean is the first start
 * \param[in] options numbers of points and rounds
 * \param[in] start single start in place of the two; may be null
 * \param[in] leading those of the points that determine the mode; null: all of them,
 *            after the source's have led there */
CalibratedEstimate
estimateCalibrated(const SurfaceScorer& scorer,
                   const HeldPrior& prior,
                   const EstimateOptions& options = EstimateOptions(),
                   const Eigen::Isometry3d* start = nullptr,
                   const SurfaceScorer* leading = nullptr);

/** \brief Give an estimate another prior. Covariance and mean follow, and the mode
 * stays. */
void
setPrior(const Prior& prior, CalibratedEstimate& estimate);

} // namespace bayesian_icp
