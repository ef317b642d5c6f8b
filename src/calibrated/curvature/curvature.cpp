#include "calibrated/curvature/curvature.h"

#include "algebra/decompositions.h"
#include "calibrated/score/score_clusters.h"
#include "geometry/principal_axes.h"
#include "geometry/twist.h"
#include "threads/for_each_piece.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Isometry3d;

namespace {

/** Length of a step in posterior standard deviations, and its limit in prior standard
 * deviations. */
constexpr double step_to_posterior_sd = 3.0;
constexpr double max_step_to_prior_sd = 1.5;

/** Limits of a step: angle [rad], and displacement as a fraction of the source's root
 * mean square radius. */
constexpr double max_step_angle = 0.3, max_step_to_radius = 0.6;

/** A step whose secant is not clear is multiplied by this factor, at most
 * max_shortenings times. */
constexpr double step_shortening = 0.25;
constexpr int max_shortenings = 3;
/** Steps shorter than this fraction of the least displacement are not tried. */
constexpr double min_shortened = 0.2;

/** A step is not measured again if its length would change by less than this factor,
 * and the cosine of its turn would be above this, in units in which posterior standard
 * deviations are one. */
constexpr double max_change_of_length = 1.5;
constexpr double min_cosine_of_turn = 0.95;

/** A secant is clear if the square of its restoring part is above this multiple of its
 * variance, twice the 99.9 % quantile of chi-square. The noise along other directions
 * does not matter for whether this one is held. */
constexpr double min_clear_ratio = 21.6;

/** Limits of the change that steps make to the residuals of the points that hold a
 * direction, in units of their scale. Noise differs by orders of magnitude between the
 * parts of a scene, so no length suits all directions. */
constexpr double least_change = 0.7, most_change = 2.0;

/** Mean squared cosine between the motion and the normal of the points that hold a
 * direction. Up to grazing nothing is trusted, from facing on everything. Measured:
 * 0.28 to 0.95 along true directions, 0 to 0.16 along free ones, but 0.015 to 0.05 on
 * hills without trees. */
constexpr double grazing = 0.06, facing = 0.12;

/** Hills are trusted, too: where as many points face the motion as few_on_hills to
 * many_on_hills, and the square of the restoring part is min_hill_ratio to three times
 * as many variances. Measured on hills: 4 to 16 points, 500 to 2300 variances; on
 * bodies of revolution up to 27 variances, on planes up to 0.7 points or with curves.
 */
constexpr double few_on_hills = 2.0, many_on_hills = 4.0, min_hill_ratio = 150.0;

/** Below max_doubted_facing, the score is measured at the step that moves these points
 * by part_of_patch of their patches' radius. Nothing is trusted if the square of its
 * restoring part is below min_squared_ratio variances, everything from three times that
 * on. */
constexpr double max_doubted_facing = 0.3, part_of_patch = 0.3;
constexpr double min_squared_ratio = 20.0;

/** Below max_doubted_facing, the number of points that face the motion matters, too.
 * Nothing is trusted up to few_facing such points, everything from many_facing on. Both
 * limits are smaller where curves hold less than many_curves of the information. Planes
 * lean along a crease that a few rings cross: up to 7.4 such points hold a motion along
 * a tunnel falsely. */
constexpr double few_facing = 7.5, many_facing = 10.0;
constexpr double many_curves = 0.15;

constexpr int num_noise_clusters = 48;
constexpr int num_noise_partitions = 3;

/** The secant along one step. */
struct Secant {
  Vector6d step;
  Vector6d difference;
  Matrix6d noise;
};

/** The points that hold a direction, each with the weight of its Gauss-Newton
 * information along a step. */
struct Holders {
  /** Fraction of the step at which their residuals have changed by tau. */
  double unit_change = std::numeric_limits<double>::infinity();
  /** Fraction of the step at which they have moved by the radius of their patches. */
  double next_patch = std::numeric_limits<double>::infinity();
  /** Mean squared cosine between their motion and their normal. */
  double facing = 1.0;
  /** Their effective number, (sum of weights)^2 / (sum of squared weights). */
  double count = 0.0;
  /** Share of the weights on patches whose points follow a curve. */
  double on_curves = 0.0;
};

/** Makes secants about one mode. Each thread has a copy. */
class SecantMaker {
public:
  SecantMaker(const SurfaceScorer& scorer,
              const Isometry3d& mode,
              const SurfaceScores& at_mode,
              double tau)
  : scorer_(scorer)
  , mode_(mode)
  , centre_(mode * scorer.centroid())
  , at_mode_(at_mode)
  , tau_(tau)
  , points_(scorer.pointsAt(mode))
  {
    scorer_.evaluate(
        mode_, centre_, std::numeric_limits<double>::infinity(), hints_, linear_);
    patches_ = hints_;
  }

  Secant
  along(const Vector6d& step, int direction)
  {
    evaluateAt(step, forward_);
    evaluateAt(-step, backward_);
    Secant secant;
    secant.step = step;
    secant.difference = 0.5 * (forward_.total - backward_.total);
    ClusterOptions options;
    options.num_clusters = num_noise_clusters;
    options.num_partitions = num_noise_partitions;
    options.stream = 1000 + static_cast<std::uint64_t>(direction);
    secant.noise =
        clusteredCovariance(unpredictedScores(step), Matrix6d::Zero(), options);
    return secant;
  }

  Holders
  holdersOf(const Vector6d& step) const
  {
    double sum = 0.0, sum_of_squares = 0.0, motions = 0.0, cosines = 0.0;
    double on_curves = 0.0;
    for (Index i = 0; i < points_.cols(); ++i) {
      const auto index = static_cast<std::size_t>(i);
      if (!at_mode_.active[index])
        continue;
      const double rate = at_mode_.jacobians.col(i).dot(step), weight = rate * rate;
      const Eigen::Vector3d arm = mode_ * points_.col(i) - centre_;
      const double motion = (step.head<3>() + step.tail<3>().cross(arm)).norm();
      const SurfacePatch& patch = scorer_.modelOf(i).patches()[patches_[index]];
      sum += weight;
      sum_of_squares += weight * weight;
      motions += weight * motion / patch.radius;
      on_curves += patch.follows_curve ? weight : 0.0;
      if (motion > 0.0) // The first half of a jacobian is along the normal.
        cosines +=
            weight * weight /
            (at_mode_.jacobians.col(i).head<3>().squaredNorm() * motion * motion);
    }
    Holders holders;
    if (sum > 0.0) {
      holders.unit_change = tau_ * std::sqrt(sum / sum_of_squares);
      holders.next_patch = motions > 0.0 ? sum / motions : holders.next_patch;
      holders.facing = cosines / sum;
      holders.count = sum * sum / sum_of_squares;
      holders.on_curves = on_curves / sum;
    }
    return holders;
  }

private:
  void
  evaluateAt(const Vector6d& step, SurfaceScores& scores)
  {
    scorer_.evaluate(movedBy(step, centre_, mode_), centre_, tau_, hints_, scores);
  }

  double
  psi(double u) const
  {
    return tukeyWeight(u / (SurfaceScorer::tukey_constant * tau_)) * u;
  }

  /** The part of the points' differences that the correspondences at the mode do not
   * predict. */
  PointScores
  unpredictedScores(const Vector6d& step) const
  {
    const Index num_points = points_.cols();
    PointScores points;
    points.scores.resize(6, num_points);
    points.positions.resize(3, num_points);
    Index count = 0;
    for (Index i = 0; i < num_points; ++i) {
      const auto index = static_cast<std::size_t>(i);
      if (!forward_.active[index] && !backward_.active[index] &&
          !linear_.has_patch[index])
        continue;
      const auto rates = linear_.jacobians.col(i);
      const double change = rates.dot(step), u = linear_.residuals[i];
      points.scores.col(count) =
          0.5 * (forward_.scores.col(i) - backward_.scores.col(i) -
                 (psi(u + change) - psi(u - change)) * rates);
      points.positions.col(count) = points_.col(i);
      ++count;
    }
    points.scores.conservativeResize(6, count);
    points.positions.conservativeResize(3, count);
    return points;
  }

  const SurfaceScorer& scorer_;
  const Isometry3d& mode_;
  Eigen::Vector3d centre_;
  const SurfaceScores& at_mode_;
  double tau_;
  /** Of both clouds, source frame. */
  Eigen::Matrix3Xd points_;
  PatchHints hints_;
  /** Of the points at the mode. */
  PatchHints patches_;
  SurfaceScores forward_{};
  SurfaceScores backward_{};
  /** At the mode, without robust weights. */
  SurfaceScores linear_{};
};

/** Square of the restoring part of a secant in units of its variance; 0 if it does not
 * restore. */
double
squaredRatio(const Secant& secant)
{
  const double signal = secant.step.dot(secant.difference);
  const double variance = secant.step.dot(secant.noise * secant.step);
  return signal > 0.0 ? signal * signal / variance : 0.0;
}

bool
isClear(const Secant& secant)
{
  return squaredRatio(secant) > min_clear_ratio;
}

/** Length of the step along an axis. */
double
lengthOf(const Vector6d& axis,
         double standard_deviation,
         double unit_change,
         const SecantPlan& plan)
{
  return std::min(longestStep(axis, plan.prior_precision, plan.displacement_metric),
                  std::clamp(step_to_posterior_sd * standard_deviation,
                             least_change * unit_change,
                             most_change * unit_change));
}

/** Whether one secant suffices for two steps because they are nearly the same, up to
 * sign.
 * \param[in] information inverse covariance: a little of a long step along a tight
 * direction matters, a little of a short one along a loose direction does not */
bool
isNearly(const Vector6d& step, const Vector6d& planned, const Matrix6d& information)
{
  const double length = std::sqrt(step.dot(information * step));
  const double planned_length = std::sqrt(planned.dot(information * planned));
  return std::abs(step.dot(information * planned)) >
             min_cosine_of_turn * length * planned_length &&
         std::max(length, planned_length) <
             max_change_of_length * std::min(length, planned_length);
}

/** The longest secant of steps from \p length down to \p shortest that is clear; the
 * longest of all if none is. */
Secant
clearSecant(SecantMaker& maker,
            const Vector6d& axis,
            double length,
            double shortest,
            int direction)
{
  const Secant widest = maker.along(length * axis, direction);
  Secant secant = widest;
  for (int i = 0; i < max_shortenings && !isClear(secant); ++i) {
    length *= step_shortening;
    if (length < shortest)
      break;
    secant = maker.along(length * axis, direction);
  }
  return isClear(secant) ? secant : widest;
}

/** H of steps and differences, symmetrised. */
Matrix6d
curvatureOf(const Secants& secants)
{
  const Matrix6d products = secants.steps.transpose() * secants.differences;
  const Matrix6d inverse = secants.steps.inverse();
  return inverse.transpose() * symmetrized(products) * inverse;
}

/** 0 up to \p from, 1 from \p to on, and linear in between. */
double
ramp(double value, double from, double to)
{
  return std::clamp((value - from) / (to - from), 0.0, 1.0);
}

/** See Secants::trust. */
double
trustIn(SecantMaker& maker, const Secant& secant, int direction)
{
  const Holders holders = maker.holdersOf(secant.step);
  const double hills =
      ramp(holders.facing * holders.count, few_on_hills, many_on_hills) *
      ramp(squaredRatio(secant), min_hill_ratio, 3.0 * min_hill_ratio);
  double trust = std::max(hills, ramp(holders.facing, grazing, facing));
  if (holders.facing >= max_doubted_facing)
    return trust;
  const double curves = std::min(1.0, holders.on_curves / many_curves);
  if (curves > 0.0)
    trust *= ramp(holders.facing * holders.count / curves, few_facing, many_facing);
  const double length = part_of_patch * holders.next_patch;
  if (trust <= 0.0 || !(length > 1.0))
    return trust;
  const double ratio = squaredRatio(maker.along(length * secant.step, direction));
  return trust * ramp(ratio, min_squared_ratio, 3.0 * min_squared_ratio);
}

/** Measure direction \p k again, unless its step is nearly that of \p previous. */
void
measureDirection(int k,
                 const PrincipalAxes& principal,
                 const SecantPlan& plan,
                 const Secants& previous,
                 SecantMaker& maker,
                 Secants& secants)
{
  const Vector6d axis = principal.axes.col(k);
  const double unit_change = maker.holdersOf(axis).unit_change;
  const double deviation = std::sqrt(std::max(0.0, principal.variances[k]));
  const double length = lengthOf(axis, deviation, unit_change, plan);
  const Vector6d step = length * axis;
  if (isNearly(step, previous.planned.col(k), plan.covariance.inverse()))
    return;
  // Directions are in the order of their spread: those that the data do not hold come
  // last in every round, and what was tried on them need not be tried again.
  const double shortest =
      std::max(min_shortened * std::min(plan.min_displacement, 0.5 * unit_change),
               previous.unclear_displacement[k]);
  const Secant secant = clearSecant(maker, axis, length, shortest, k);
  secants.unclear_displacement[k] = isClear(secant) ? 0.0 : length;
  secants.planned.col(k) = step;
  secants.steps.col(k) = secant.step;
  secants.differences.col(k) = secant.difference;
  secants.noise[static_cast<std::size_t>(k)] = secant.noise;
}

} // namespace

double
longestStep(const Vector6d& axis,
            const Matrix6d& prior_precision,
            const Matrix6d& displacement_metric)
{
  const double angle = axis.tail<3>().norm();
  return std::min(
      {max_step_to_prior_sd / std::sqrt(axis.dot(prior_precision * axis)),
       max_step_to_radius * radiusOf(displacement_metric),
       angle > 0.0 ? max_step_angle / angle : std::numeric_limits<double>::infinity()});
}

Secants
measureSecants(const SurfaceScorer& scorer,
               const Isometry3d& mode,
               const SurfaceScores& at_mode,
               double tau,
               const SecantPlan& plan,
               const Secants& previous)
{
  const PrincipalAxes principal(plan.covariance, plan.displacement_metric);
  const SecantMaker about_mode(scorer, mode, at_mode, tau);
  Secants secants = previous;
  forEachPiece(6, plan.num_threads, [&](std::ptrdiff_t piece) {
    const int k = static_cast<int>(piece);
    SecantMaker maker = about_mode;
    measureDirection(k, principal, plan, previous, maker, secants);
    secants.trust[k] = trustIn(maker,
                               {secants.steps.col(k),
                                secants.differences.col(k),
                                secants.noise[static_cast<std::size_t>(k)]},
                               k);
  });
  secants.curvature = curvatureOf(secants);
  return secants;
}

} // namespace bayesian_icp
