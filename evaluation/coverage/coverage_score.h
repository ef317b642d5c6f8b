/** \file
 * \brief Scores of one posterior against the truth: is it where and as wide as it says?
 */
#pragma once

#include "study/coverage_case.h"

#include <cmath>
#include <limits>
#include <string>

namespace bayesian_icp::evaluate {

/** \brief A vector of NaN. */
inline Vector6d
unknownVector()
{
  return Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
}

/** \brief What is kept of a run: NaN where the method gave nothing. Coordinates are
 * twists (v, w) about MethodResult::centre. The truth's own accuracy is added to every
 * spread. */
struct CoverageScore {
  /** Whether there is a posterior. */
  bool is_valid = false;
  /** Squared Mahalanobis distance of the truth to the mean; chi-square with 6 degrees
   * of freedom if the posterior is right. */
  double nees = std::numeric_limits<double>::quiet_NaN();
  /** Probability of the smallest region about the mean that has the truth, regionOf();
   * uniform if the posterior is right. */
  double region = std::numeric_limits<double>::quiet_NaN();
  /** log density of the Gaussian of the posterior's moments at the truth, in
   * coordinates in units of the prior's standard deviations [nats]. Of recordings,
   * which have a limit of \p displacement: in metres and radians, and at least
   * min_log_score. */
  double log_score = std::numeric_limits<double>::quiet_NaN();
  /** E|X - t| - E|X - X'| / 2 in units of the prior's standard deviations; smaller is
   * better. */
  double energy_score = std::numeric_limits<double>::quiet_NaN();
  /** Posterior probability of a smaller coordinate than the true one; uniform if the
   * posterior is right. */
  Vector6d pit = unknownVector();
  /** Distance of the mean to the truth in standard deviations, and these in units of
   * the prior's. */
  Vector6d z = unknownVector();
  Vector6d relative_sd = unknownVector();
  /** Of the source's centroid [m], and of the rotation [rad]. */
  double translation_error = std::numeric_limits<double>::quiet_NaN();
  double rotation_error = std::numeric_limits<double>::quiet_NaN();
  /** Mean of the source's points between the pose and the truth [m], and beyond which
   * the pose is lost; NaN without a pose, or a limit. */
  double displacement = std::numeric_limits<double>::quiet_NaN();
  double lost_displacement = std::numeric_limits<double>::quiet_NaN();
  double seconds = std::numeric_limits<double>::quiet_NaN();
  long num_queries = -1;
  std::string notes;

  /** \brief Whether the method itself doubts the result: a note begins with "flag:". */
  bool
  isFlagged() const;

  bool
  hasPose() const
  {
    return !std::isnan(displacement);
  }

  bool
  hasLimit() const
  {
    return !std::isnan(lost_displacement);
  }

  /** \brief Whether the pose is beyond the limit, if there is one, or missing. */
  bool
  isLost() const
  {
    return hasLimit() && !(displacement <= lost_displacement);
  }
};

/** \brief Probability of a smaller squared Mahalanobis distance than \p nees: that of
 * the smallest ellipsoid about the mean with the shape of the covariance that has the
 * truth. Uniform if the posterior is right. NaN of NaN. */
double
regionOf(double nees, const RegionShape& shape = RegionShape());

/** \brief Least log score of a recording's pair [nats]: one lost pair is not to decide
 * a mean. */
constexpr double min_log_score = -50.0;

/** \brief Score a result. One that is not a posterior (a mean that is not finite, a
 * covariance that is not positive definite, fewer than 8 draws) is not valid, and a
 * note says so; of recordings it is scored as the worst there is. A pose alone has
 * errors and a displacement only. The energy score of a Gaussian is that of 2000 draws
 * of it, made from the case's seed. */
CoverageScore
coverageScoreOf(const CoverageCase& problem, const MethodResult& result);

} // namespace bayesian_icp::evaluate
