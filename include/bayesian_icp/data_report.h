/** \file
 * \brief What the data say about the pose, direction by direction, and what in them
 * calls for caution (preset `calibrated`).
 */
#pragma once

#include <bayesian_icp/export.h>
#include <bayesian_icp/pose.h>

#include <limits>
#include <string>
#include <vector>

namespace bayesian_icp {

/** \brief How well the data hold a motion. */
enum class Observability {
  /** By the data. */
  Observed,
  /** By the data, but hardly above their noise, or less than by the prior. */
  Weak,
  /** Not by the data: the posterior is the prior. */
  PriorOnly
};

/** \brief Share of the information along a direction that is above its noise, below
 * which the direction is weak. */
constexpr double min_observed_share_above_noise = 0.5;
/** \brief Ratio of posterior to prior standard deviation from which a direction is
 * weak: the data then say less about it than the prior does. */
constexpr double max_observed_share_of_prior = 0.7071;
/** \brief Ratio of posterior to prior standard deviation from which a direction is held
 * by the prior only, whatever little the data add. */
constexpr double max_share_of_prior = 0.99;
/** \brief Flags are raised beyond these; why there: docs/calibration_flags.md. */
constexpr double max_basin_distance = 3.0;
constexpr double max_other_cost_ratio = 1.02;
constexpr double min_active_fraction = 0.4;
constexpr double min_effective_patches = 20.0;
constexpr double max_residual_scale = 10.0;
constexpr double max_residual_scale_if_free = 2.0;
constexpr double min_prior_probability = 0.001;

/** \brief Short name: "observed", "weak", "prior_only". */
BAYESIAN_ICP_EXPORT const char*
toString(Observability observability);

/** \brief One motion and how well it is known. The six of a report are independent of
 * each other, both in the posterior and in the prior. */
struct DataDirection {
  /** Left twist (v, w) about DataReport::centre, target frame, of unit root mean
   * squared displacement of the source's points [1, rad/m]. */
  Vector6d twist = Vector6d::Zero();
  /** Posterior and prior standard deviation along it, as root mean squared displacement
   * of the source's points [m]. */
  double standard_deviation = std::numeric_limits<double>::quiet_NaN();
  double prior_standard_deviation = std::numeric_limits<double>::quiet_NaN();
  /** lambda: information of the data along it, in units of the prior's. The posterior's
   * standard deviation is the prior's / sqrt(1 + lambda). */
  double relative_information = 0.0;
  Observability observability = Observability::Observed;
  /** In words: see describeTwist(). */
  std::string description;
};

/** \brief Things that make a posterior doubtful. */
struct DataFlags {
  /** The two starts ended more than max_basin_distance apart, and the worse of the two
   * ends costs no more than max_other_cost_ratio times the better one: either may be
   * right. */
  bool wrong_basin = false;
  /** Less than min_active_fraction of the source points lie on the target's surface. */
  bool low_support = false;
  /** Fewer than min_effective_patches independent patches hold the pose, or fewer than
   * 28 where residual_scale is above 3: too few to rely on the width. */
  bool few_patches = false;
  /** The surfaces disagree by more than the noise: residual_scale above
   * max_residual_scale, or above max_residual_scale_if_free where the prior alone holds
   * a direction, which the disagreement may hide. Or they agree better than the
   * target's noise allows, as clouds without noise do: residual_scale is at its floor
   * of 0.3. */
  bool misfit = false;
  /** All six directions are held by the prior only. */
  bool no_information = false;
  /** The clouds put the pose where the prior has it with a probability below
   * min_prior_probability: one of the two is wrong. */
  bool prior_conflict = false;

  bool
  any() const
  {
    return wrong_basin || low_support || few_patches || misfit || no_information ||
           prior_conflict;
  }
};

/** \brief The report of preset `calibrated`; of the heaviest mode if there are several.
 */
struct BAYESIAN_ICP_EXPORT DataReport {
  /** False for the other presets: all else is then meaningless. */
  bool is_available = false;
  /** Standard deviation of a source point's distance to the target's surface [m]. */
  double noise_scale = std::numeric_limits<double>::quiet_NaN();
  /** The same in units of the target's own noise: 1 to 1.5 if all is well. */
  double residual_scale = std::numeric_limits<double>::quiet_NaN();
  /** Number of independent patches of surface that the information amounts to: 96
   * kappa_48 / kappa_inf, about 96 where neighbouring points are independent. */
  double effective_patches = std::numeric_limits<double>::quiet_NaN();
  /** Share of the source points that lie on the target's surface, in [0, 1]. */
  double active_fraction = std::numeric_limits<double>::quiet_NaN();
  /** kappa_inf: by how much neighbouring points repeat each other. */
  double correlation_factor = std::numeric_limits<double>::quiet_NaN();
  /** nu of Student's t distribution, scaled to the covariance, that the draws have
   * along the directions that the data hold: its 95 % region in six of them is at a
   * squared Mahalanobis distance of 5.4 F_0.95(6, nu) = 14.0 for nu = 20, not 12.6. */
  int degrees_of_freedom = 0;
  /** Mahalanobis distance between the ends of the two starts, without what is held by
   * the prior only. Its covariance is the posterior's, widened by half the noise, as
   * starts do not converge further. */
  double basin_distance = std::numeric_limits<double>::quiet_NaN();
  /** Mean capped residual at the worse of the two ends, in units of the better one's.
   */
  double other_cost_ratio = std::numeric_limits<double>::quiet_NaN();
  /** Probability that a pose drawn from the prior is further from the prior's mean than
   * the posterior's mean is, along the directions that are not held by the prior only.
   * Uniform in [0, 1] if poses are drawn from the prior. */
  double prior_probability = std::numeric_limits<double>::quiet_NaN();
  /** Centre of the twists: the moved source's centroid, target frame [m]. */
  Eigen::Vector3d centre =
      Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  /** Six directions, best known first. */
  std::vector<DataDirection> directions;
  DataFlags flags;
};

/** \brief The flags of a report's numbers. A number that is not finite raises its flag.
 */
BAYESIAN_ICP_EXPORT DataFlags
flagsOf(const DataReport& report);

/** \brief A twist in words: "translation along (0.98, 0.10, 0.10)", "rotation about
 * (0.00, 0.00, 1.00) through (0.100, 0.200, 0.050) m", "screw about ... with a pitch of
 * 0.250 m/rad". Opposite twists have the same words. Translation is what moves all
 * points nearly alike; the point is the axis' nearest to the centre.
 * \param[in] twist left, target frame, of unit rms displacement [1, rad/m]
 * \param[in] centre of the twist, target frame [m] */
BAYESIAN_ICP_EXPORT std::string
describeTwist(const Vector6d& twist, const Eigen::Vector3d& centre);

/** \brief The raised flags in words, each with its number and threshold; empty if none.
 */
BAYESIAN_ICP_EXPORT std::vector<std::string>
describeFlags(const DataReport& report);

} // namespace bayesian_icp
