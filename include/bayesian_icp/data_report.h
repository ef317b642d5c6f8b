/** \file
 * \brief Preset `calibrated`: how well the data determine the pose in each direction,
 * and warnings.
 */
#pragma once

#include <bayesian_icp/export.h>
#include <bayesian_icp/pose.h>

#include <limits>
#include <string>
#include <vector>

namespace bayesian_icp {

/** \brief How well the data determine a motion. */
enum class Observability {
  /** The data determine it. */
  Observed,
  /** The data determine it, but mostly within their noise, or less than the prior does.
   */
  Weak,
  /** The data do not determine it: the posterior is the prior. */
  PriorOnly
};

/** \brief A direction is Weak if less than this share of its information is above the
 * noise. */
constexpr double min_observed_share_above_noise = 0.5;
/** \brief A direction is Weak from this ratio of posterior to prior standard deviation
 * on: the data then contribute less information than the prior. */
constexpr double max_observed_share_of_prior = 0.7071;
/** \brief A direction is PriorOnly from this ratio of posterior to prior standard
 * deviation on, even if the data contribute a little. */
constexpr double max_share_of_prior = 0.99;
/** \brief Thresholds of the flags; docs/calibration_flags.md gives the reasons. */
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

/** \brief One motion and how well it is known. The six motions of a report are
 * independent of each other, in the posterior and in the prior. */
struct DataDirection {
  /** Left twist (v, w) about DataReport::centre, target frame [1, rad/m]. It is scaled
   * so that the root mean squared displacement of the source's points is one. */
  Vector6d twist = Vector6d::Zero();
  /** Posterior and prior standard deviation along the twist, as root mean squared
   * displacement of the source's points [m]. */
  double standard_deviation = std::numeric_limits<double>::quiet_NaN();
  double prior_standard_deviation = std::numeric_limits<double>::quiet_NaN();
  /** lambda: information of the data along the twist, in units of the prior's. The
   * standard deviation of the posterior is that of the prior / sqrt(1 + lambda). */
  double relative_information = 0.0;
  Observability observability = Observability::Observed;
  /** The twist in words: see describeTwist(). */
  std::string description;
};

/** \brief Reasons to doubt a posterior. Any of them turns Status::Ok into
 * Status::Doubtful. */
struct DataFlags {
  /** The two starts ended more than max_basin_distance apart, and the worse end costs
   * no more than max_other_cost_ratio times the better one. Either may be right. */
  bool wrong_basin = false;
  /** In both clouds, less than min_active_fraction of the points lie on the surface of
   * the other one. */
  bool low_support = false;
  /** Fewer than min_effective_patches independent patches determine the pose, or fewer
   * than 28 if residual_scale is above 3. Do not rely on the width of the posterior. */
  bool few_patches = false;
  /** The surfaces disagree by more than the noise: residual_scale is above
   * max_residual_scale, or above max_residual_scale_if_free if the prior alone
   * determines a direction, which may hide the disagreement. Also raised if the
   * surfaces agree better than the target's noise allows (residual_scale is at its
   * floor of 0.3), as for clouds without noise. */
  bool misfit = false;
  /** The prior alone determines all six directions. */
  bool no_information = false;
  /** The clouds determine a pose whose prior_probability is below
   * min_prior_probability: the prior or the registration is wrong. */
  bool prior_conflict = false;

  bool
  any() const
  {
    return wrong_basin || low_support || few_patches || misfit || no_information ||
           prior_conflict;
  }

  /** \brief Whether the pose may be much further off than the covariance states.
   * Between scans of one real sequence that hardly overlap, low_support and misfit
   * together were as often wrong as right. */
  bool
  mayBeInAnotherBasin() const
  {
    return wrong_basin || (low_support && misfit);
  }
};

/** \brief A flag and its name in files and in Python. */
struct DataFlag {
  const char* key;
  bool DataFlags::*is_raised;
};

/** \brief All flags. */
constexpr DataFlag data_flags[] = {{"wrong_basin", &DataFlags::wrong_basin},
                                   {"low_support", &DataFlags::low_support},
                                   {"few_patches", &DataFlags::few_patches},
                                   {"misfit", &DataFlags::misfit},
                                   {"no_information", &DataFlags::no_information},
                                   {"prior_conflict", &DataFlags::prior_conflict}};
static_assert(sizeof(data_flags) == sizeof(DataFlags) * sizeof(DataFlag),
              "data_flags has every flag");

/** \brief The report of preset `calibrated`. If there are several modes, it describes
 * the heaviest one. */
struct BAYESIAN_ICP_EXPORT DataReport {
  /** False for the other presets: all other members are then meaningless. */
  bool is_available = false;
  /** Standard deviation of a source point's distance to the target's surface [m]. */
  double noise_scale = std::numeric_limits<double>::quiet_NaN();
  /** noise_scale in units of the target's own noise, or of the source's if the target
   * is far cleaner. Normally 1 to 1.5. */
  double residual_scale = std::numeric_limits<double>::quiet_NaN();
  /** Number of independent patches of surface with the same information: 96 max(1,
   * kappa_48) / kappa_inf. It is about 96 if neighbouring points are independent. */
  double effective_patches = std::numeric_limits<double>::quiet_NaN();
  /** Share of the source points that lie on the target's surface, in [0, 1]. */
  double active_fraction = std::numeric_limits<double>::quiet_NaN();
  /** Share of the target points that lie on the source's surface, in [0, 1]; NaN if
   * they are not compared, because the source has no usable surface or is so sparse
   * that its own points say more. Points further away than the prior allows do not
   * count. */
  double active_fraction_of_target = std::numeric_limits<double>::quiet_NaN();
  /** kappa_inf: factor by which correlation between neighbouring points inflates the
   * covariance of the score. */
  double correlation_factor = std::numeric_limits<double>::quiet_NaN();
  /** nu of Student's t distribution, from which the draws are taken in the directions
   * that the data determine. It is scaled to the covariance: in six such directions the
   * 95 % region ends at a squared Mahalanobis distance of 5.4 F_0.95(6, nu) = 14.0 for
   * nu = 20, not 12.6. */
  int degrees_of_freedom = 0;
  /** Mahalanobis distance between the ends of the two starts, without PriorOnly
   * directions. Its covariance is the posterior's, widened by half the noise, because
   * starts do not converge further. */
  double basin_distance = std::numeric_limits<double>::quiet_NaN();
  /** Cost at the worse of the two ends, divided by that at the better one. A cost is
   * the mean capped residual of the source points with a patch at both ends or, if
   * these do not tell the ends apart, of all. */
  double other_cost_ratio = std::numeric_limits<double>::quiet_NaN();
  /** Probability that the posterior's mean would be further from the prior's mean than
   * it is if the prior were right, without PriorOnly directions. Uniform in [0, 1] if
   * the poses are drawn from the prior. If the clouds meet clearly better outside of a
   * narrow prior, it is at most the probability of being as far away as there. */
  double prior_probability = std::numeric_limits<double>::quiet_NaN();
  /** Centre of the twists: the moved source's centroid, target frame [m]. */
  Eigen::Vector3d centre =
      Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  /** Six directions, best known first. */
  std::vector<DataDirection> directions;
  DataFlags flags;
};

/** \brief Compute the flags from a report's numbers. A number that is not finite raises
 * its flag. */
BAYESIAN_ICP_EXPORT DataFlags
flagsOf(const DataReport& report);

/** \brief Describe a twist in words: "translation along (0.98, 0.10, 0.10)", "rotation
 * about (0.00, 0.00, 1.00) through (0.100, 0.200, 0.050) m", "screw about ... with a
 * pitch of 0.250 m/rad".
 *
 * Opposite twists have the same description. A motion counts as a translation if it
 * moves all points nearly alike. The given point is the point of the axis that is
 * nearest to the centre.
 * \param[in] twist left, target frame, of unit rms displacement [1, rad/m]
 * \param[in] centre of the twist, target frame [m] */
BAYESIAN_ICP_EXPORT std::string
describeTwist(const Vector6d& twist, const Eigen::Vector3d& centre);

/** \brief Describe how much of each cloud lies on the surface of the other one, and
 * that the target's points were not compared if they were not. */
BAYESIAN_ICP_EXPORT std::string
describeSupport(const DataReport& report);

/** \brief Describe the raised flags, each with its number and threshold. Empty if none
 * is raised. */
BAYESIAN_ICP_EXPORT std::vector<std::string>
describeFlags(const DataReport& report);

} // namespace bayesian_icp
