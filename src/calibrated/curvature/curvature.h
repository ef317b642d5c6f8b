/** \file
 * \brief Curvature of the surface likelihood with correspondences made anew, and how
 * much of it is above its noise.
 */
#pragma once

#include "calibrated/score/surface_score.h"

#include <array>

namespace bayesian_icp {

/** \brief Where and how far the curvature is measured. Twists about \p centre. */
struct SecantPlan {
  /** Directions are the principal axes of this covariance in the displacement metric,
   * and three of its standard deviations the length of the steps, as far as that
   * changes the residuals of the points that hold a direction by 0.7 to 2 of their
   * scale. */
  Matrix6d covariance;
  /** The source's mean squared displacement of a twist is xi^T D xi [m^2]. */
  Matrix6d displacement_metric;
  /** No step is longer than 1.5 prior standard deviations, 0.3 rad, or 0.6 of the
   * source's root mean square radius. */
  Matrix6d prior_precision;
  /** Steps are not shortened below a fifth of this root mean squared displacement [m],
   * unless a half of what changes the residuals by their scale is less. */
  double min_displacement;
};

/** \brief Central differences of the total score along six steps. */
struct Secants {
  /** Columns are the steps, tightest direction first [m, rad]. */
  Matrix6d steps = Matrix6d::Zero();
  /** The steps before they were shortened. */
  Matrix6d planned = Matrix6d::Zero();
  /** Where a secant is not above its noise, the root mean squared displacement of its
   * step, and 0 elsewhere [m]. */
  Vector6d unclear_displacement = Vector6d::Zero();
  /** Half the difference of the scores at +step and -step. */
  Matrix6d differences = Matrix6d::Zero();
  /** Covariance of each difference, without what the correspondences of the mode
   * predict of it. */
  std::array<Matrix6d, 6> noise = {};
  /** Share of each step's information that is to be trusted, in [0, 1]: less where
   * points that hold the direction move along their surface, so that only its slopes
   * speak of it, and nothing is left of their scores once they have met other patches.
   */
  Vector6d trust = Vector6d::Ones();
  /** H: symmetric, in the twists' coordinates. */
  Matrix6d curvature = Matrix6d::Zero();
  /** Evaluations of all points that were needed. */
  int num_evaluations = 0;
};

/** \brief Measure the curvature about a mode.
 * \param[in] scorer of the source against the target's surface
 * \param[in] mode T_target_source
 * \param[in] at_mode scores there
 * \param[in] tau scale of the residuals in Tukey's weight
 * \param[in] plan directions and lengths of the steps
 * \param[in] previous secants about the same mode, which are kept where the step would
 *            be nearly the same */
Secants
measureSecants(const SurfaceScorer& scorer,
               const Eigen::Isometry3d& mode,
               const SurfaceScores& at_mode,
               double tau,
               const SecantPlan& plan,
               const Secants& previous = Secants());

/** \brief The steps; from those that are not \p held the part is taken along the held
 * ones that accounts for their secants, unless that part is longer than a fifth of the
 * step, both in prior standard deviations. */
Matrix6d
alongTheSurface(const Secants& secants,
                const std::array<bool, 6>& held,
                const Matrix6d& prior_precision);

/** \brief Factor c on the expected noise tr(J^-1 N) of a secant's information, which
 * noise alone exceeds with a probability of 1 in 1000 (Wilson and Hilferty's
 * approximation of chi-square, with the noise's own number of degrees of freedom). */
double
noiseThreshold(const Matrix6d& score_covariance, const Matrix6d& noise);

/** \brief What is left of the curvature after its noise is debited. */
struct DebitedInformation {
  /** keep_k = trust_k max(0, 1 - d_k / info_k), one per step: d_k is c tr(J^-1 N_k), c
   * of noiseThreshold(), where info_k is no more than that, falling to the noise's mean
   * tr(J^-1 N_k) where it is three times that; trust_k is that of the secant. */
  Vector6d keep = Vector6d::Zero();
  /** info_k: information of the data along each step before the debit. */
  Vector6d raw = Vector6d::Zero();
  /** V: the steps. Those that keep nothing are turned towards the others such that the
   * score stays as it is, by the secants: a prior may let the pose go far along them,
   * where a small tilt of an axis is a large distance from the surface. */
  Matrix6d steps = Matrix6d::Identity();
  /** T = V diag(sqrt(keep)) V^-1. */
  Matrix6d transfer = Matrix6d::Zero();
  /** Lambda = T^T H J^-1 H T. */
  Matrix6d information = Matrix6d::Zero();
};

/** \brief Debit the noise. A direction that keeps less than \p min_relative_information
 * times the prior's information along it keeps nothing. */
DebitedInformation
debitedInformation(const Secants& secants,
                   const Matrix6d& score_covariance,
                   const Matrix6d& prior_precision,
                   double min_relative_information);

} // namespace bayesian_icp
