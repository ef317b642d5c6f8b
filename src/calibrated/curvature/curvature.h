/** \file
 * \brief Curvature of the surface likelihood, and how much of it is above its noise.
 *
 * Correspondences are searched again at each end of a step.
 */
#pragma once

#include "calibrated/score/surface_score.h"

#include <array>

namespace bayesian_icp {

/** \brief Directions and lengths of the steps that measure the curvature. Twists are
 * about the moved source's centroid. */
struct SecantPlan {
  /** The directions are the principal axes of this covariance in the displacement
   * metric. A step is three of its standard deviations long, limited to the steps that
   * change the residuals of the points that hold the direction by 0.7 and by 2 times
   * their scale. */
  Matrix6d covariance;
  /** D: the mean squared displacement of the source's points by a twist xi is xi^T D xi
   * [m^2]. */
  Matrix6d displacement_metric;
  /** No step is longer than longestStep(). */
  Matrix6d prior_precision;
  /** Root mean squared displacement [m]. Steps are not shortened below a fifth of it,
   * or below a fifth of half the step that changes the residuals by their scale,
   * whichever is less. */
  double min_displacement;
  /** 0: as OpenMP would. No result depends on it. */
  int num_threads = 1;
};

/** \brief Central differences of the total score along six steps. */
struct Secants {
  /** Columns are the steps, tightest direction first [m, rad]. */
  Matrix6d steps = Matrix6d::Zero();
  /** The steps before they were shortened. */
  Matrix6d planned = Matrix6d::Zero();
  /** Root mean squared displacement of each step whose secant is not clearly above its
   * noise; 0 for the other steps [m]. */
  Vector6d unclear_displacement = Vector6d::Zero();
  /** Half the difference of the scores at +step and -step. */
  Matrix6d differences = Matrix6d::Zero();
  /** Covariance of the part of each difference that the correspondences at the mode do
   * not predict. */
  std::array<Matrix6d, 6> noise = {};
  /** Share of each step's information to trust, in [0, 1]. It may be less than 1 where
   * the points that hold the direction move along their surface. Only the slopes of the
   * surface then resist the motion, and the scores may vanish as soon as the points
   * meet other patches. */
  Vector6d trust = Vector6d::Ones();
  /** H: symmetric, in the twists' coordinates. */
  Matrix6d curvature = Matrix6d::Zero();
};

/** \brief Length of the longest step along an axis of unit displacement [m]: the least
 * of 1.5 prior standard deviations, 0.3 rad, and 0.6 of the source's root mean square
 * radius. Further away, points meet another side of the body, or its end. */
double
longestStep(const Vector6d& axis,
            const Matrix6d& prior_precision,
            const Matrix6d& displacement_metric);

/** \brief Measure the curvature about a mode.
 * \param[in] scorer of both clouds
 * \param[in] mode T_target_source
 * \param[in] at_mode scores at the mode
 * \param[in] tau scale of the residuals in Tukey's weight
 * \param[in] plan directions and lengths of the steps
 * \param[in] previous secants about the same mode, kept where the new step is nearly
 *            the same */
Secants
measureSecants(const SurfaceScorer& scorer,
               const Eigen::Isometry3d& mode,
               const SurfaceScores& at_mode,
               double tau,
               const SecantPlan& plan,
               const Secants& previous = Secants());

/** \brief Factor c such that the information of pure noise exceeds c tr(J^-1 N) with a
 * probability of 1 in 1000. tr(J^-1 N) is the expected value of that information. The
 * quantile is that of chi-square in the approximation of Wilson and Hilferty, with the
 * degrees of freedom of the noise. */
double
noiseThreshold(const Matrix6d& score_covariance, const Matrix6d& noise);

/** \brief T = V diag(sqrt(keep)) V^-1.
 * \param[in] directions V, one per column */
Matrix6d
transferOf(const Matrix6d& directions, const Vector6d& keep);

/** \brief Information that remains after the noise of the curvature is debited. */
struct DebitedInformation {
  /** keep_k = trust_k max(0, 1 - d_k / info_k), one per step. The debit d_k is c
   * tr(J^-1 N_k) where info_k is at most that, with c from noiseThreshold(). It falls
   * to the noise's mean tr(J^-1 N_k) where info_k is at least three times that
   * threshold. trust_k is Secants::trust. */
  Vector6d keep = Vector6d::Zero();
  /** info_k: information of the data along each step before the debit. */
  Vector6d raw = Vector6d::Zero();
  /** T: transferOf() the steps. */
  Matrix6d transfer = Matrix6d::Zero();
  /** Lambda = T^T H J^-1 H T. */
  Matrix6d information = Matrix6d::Zero();
};

/** \brief Debit the noise. A direction keeps nothing if less than its \p
 * least_information, that along the step, would remain. */
DebitedInformation
debitedInformation(const Secants& secants,
                   const Matrix6d& score_covariance,
                   const Vector6d& least_information);

} // namespace bayesian_icp
