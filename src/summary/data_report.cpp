#include "options/enumerator_names.h"
#include "summary/plain_text.h"

#include <bayesian_icp/data_report.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace bayesian_icp {

namespace {

/** Share of the mean squared displacement from which a motion is a translation. The
 * rest then moves points by less than a quarter of it. */
constexpr double min_translation_share = 0.95;
/** Share of the motion along the axis from which a rotation is a screw. */
constexpr double min_screw_share = 0.05;

/** Residuals above this part of their largest scale that repeat each other over large
 * patches are those of another shape: then more patches are required. */
constexpr double part_of_misfit = 0.3;
constexpr double min_patches_with_misfit = 28.0;

/** residualScale() is at least 0.3. At this floor, the residuals have another noise
 * than the target. */
constexpr double min_residual_scale = 0.301;

/** "(0.98, 0.10, 0.10)": rounded, without the sign of -0.00. */
std::string
textOf(const Eigen::Vector3d& vector, int num_decimals)
{
  const double unit = std::pow(10.0, -num_decimals);
  const Eigen::Array3d multiples = (vector / unit).array().round();
  const Eigen::Array3d rounded = (multiples == 0.0).select(0.0, multiples * unit);
  return formatted("(%.*f, %.*f, %.*f)",
                   num_decimals,
                   rounded[0],
                   num_decimals,
                   rounded[1],
                   num_decimals,
                   rounded[2]);
}

/** The one of two opposite directions whose first large component is positive. */
Eigen::Vector3d
canonicalDirection(const Eigen::Vector3d& vector)
{
  Eigen::Vector3d direction = vector.normalized();
  const double large = 0.5 * direction.cwiseAbs().maxCoeff();
  for (int k = 0; k < 3; ++k)
    if (std::abs(direction[k]) >= large) {
      if (direction[k] < 0.0)
        direction = -direction;
      break;
    }
  return direction;
}

bool
isFree(const DataDirection& direction)
{
  return direction.observability == Observability::PriorOnly;
}

bool
hasFreeDirection(const DataReport& report)
{
  return std::any_of(report.directions.begin(), report.directions.end(), isFree);
}

/** Largest residual_scale without a flag. */
double
largestScale(const DataReport& report)
{
  return hasFreeDirection(report) ? max_residual_scale_if_free : max_residual_scale;
}

double
leastPatches(const DataReport& report)
{
  return report.residual_scale > part_of_misfit * max_residual_scale
             ? min_patches_with_misfit
             : min_effective_patches;
}

double
leastShareOfPrior(const DataReport& report)
{
  double least = 1.0;
  for (const DataDirection& direction : report.directions)
    least = std::min(least,
                     direction.standard_deviation / direction.prior_standard_deviation);
  return least;
}

} // namespace

const char*
toString(Observability observability)
{
  return nameOf(observability, {"observed", "weak", "prior_only"});
}

DataFlags
flagsOf(const DataReport& report)
{
  DataFlags flags;
  flags.wrong_basin = !(report.basin_distance <= max_basin_distance ||
                        report.other_cost_ratio > max_other_cost_ratio);
  flags.low_support =
      !(std::fmax(report.active_fraction, report.active_fraction_of_target) >=
        min_active_fraction);
  flags.few_patches = !(report.effective_patches >= leastPatches(report));
  flags.misfit = !(report.residual_scale >= min_residual_scale &&
                   report.residual_scale <= largestScale(report));
  flags.no_information =
      std::all_of(report.directions.begin(), report.directions.end(), isFree);
  flags.prior_conflict = !(report.prior_probability >= min_prior_probability);
  return flags;
}

std::string
describeTwist(const Vector6d& twist, const Eigen::Vector3d& centre)
{
  const Eigen::Vector3d v = twist.head<3>(), w = twist.tail<3>();
  if (twist.isZero(0.0))
    return "no motion";
  if (w.isZero(0.0) || v.squaredNorm() >= min_translation_share)
    return "translation along " + textOf(canonicalDirection(v), 2);
  const double pitch = v.dot(w) / w.squaredNorm();
  const Eigen::Vector3d point = centre + w.cross(v) / w.squaredNorm();
  const std::string axis =
      textOf(canonicalDirection(w), 2) + " through " + textOf(point, 3) + " m";
  const double share_along_axis = pitch * pitch * w.squaredNorm();
  if (share_along_axis < min_screw_share)
    return "rotation about " + axis;
  return "screw about " + axis + formatted(" with a pitch of %.3f m/rad", pitch);
}

std::string
describeSupport(const DataReport& report)
{
  const std::string source =
      formatted("%.0f %% of the source points lie on the target's surface",
                100.0 * report.active_fraction);
  return std::isnan(report.active_fraction_of_target)
             ? source + ", the target's points are not compared"
             : source + formatted(", %.0f %% of the target's on the source's",
                                  100.0 * report.active_fraction_of_target);
}

std::vector<std::string>
describeFlags(const DataReport& report)
{
  std::vector<std::string> texts;
  if (report.flags.wrong_basin)
    texts.push_back(
        formatted("two starts ended %.1f standard deviations apart (at most "
                  "%.0f) and fit alike, with residuals in a ratio of %.2f "
                  "(told apart from %.2f on), so that the pose may be a "
                  "wrong one",
                  report.basin_distance,
                  max_basin_distance,
                  report.other_cost_ratio,
                  max_other_cost_ratio));
  if (report.flags.low_support)
    texts.push_back("only " + describeSupport(report) +
                    formatted("; at least %.0f %% of one cloud are needed",
                              100.0 * min_active_fraction));
  if (report.flags.few_patches)
    texts.push_back(formatted(
        "the pose is held by about %.0f independent patches of surface (at least %.0f)",
        report.effective_patches,
        leastPatches(report)));
  if (report.flags.misfit && report.residual_scale < min_residual_scale)
    texts.push_back(
        "the residuals are far below the target's noise, whose scale is then "
        "not known: clouds without noise have none");
  else if (report.flags.misfit)
    texts.push_back(formatted(
        "the surfaces disagree by more than the noise: residuals "
        "of %.1f times the target's noise (at most %.0f%s)",
        report.residual_scale,
        largestScale(report),
        hasFreeDirection(report) ? " where the prior alone holds a motion" : ""));
  if (report.flags.no_information)
    texts.push_back(formatted(
        "the data hold none of the six motions: along each the posterior is at least "
        "%.1f %% of the prior (at most %.0f %% for one of them)",
        100.0 * leastShareOfPrior(report),
        100.0 * max_share_of_prior));
  if (report.flags.prior_conflict)
    texts.push_back(
        formatted("the clouds contradict the prior: it has a pose as far from "
                  "its mean as this one with a probability of %.1g (at "
                  "least %.3f)",
                  report.prior_probability,
                  min_prior_probability));
  return texts;
}

} // namespace bayesian_icp
