#include "principal_axes.h"

#include <bayesian_icp/calibration/curvature.h>
#include <bayesian_icp/calibration/score_clusters.h>
#include <bayesian_icp/calibration/twist.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Isometry3d;

namespace {

/** Length of a step in posterior, and at most in prior, standard deviations. */
constexpr double step_to_posterior_sd = 3.0;
constexpr double max_step_to_prior_sd = 1.5;

/** Longest steps: further away another side of the body, or its end, is met.
 * [rad], and displacement in parts of the source's root mean square radius. */
constexpr double max_step_angle = 0.3, max_step_to_radius = 0.6;

/** A step whose secant is below its noise is shortened by this factor, so many times.
 */
constexpr double step_shortening = 0.25;
constexpr int max_shortenings = 3;
/** Steps shorter than this part of the least displacement are not tried. */
constexpr double min_shortened = 0.2;

/** A step that would change by less than this factor, and turn by less than this cosine
 * where posterior standard deviations are one, is not measured again. */
constexpr double max_change_of_length = 1.5;
constexpr double min_cosine_of_turn = 0.95;

/** A secant is clear if its information is so many times the noise threshold. */
constexpr double clear_to_threshold = 2.0;

constexpr int num_noise_clusters = 48;
constexpr int num_noise_partitions = 3;

/** The secant along one step. */
struct Secant {
  Vector6d step;
  Vector6d difference;
  Matrix6d noise;
};

/** Length of the longest step along \p axis, which is of unit displacement. */
double
longestStep(const Vector6d& axis, const SecantPlan& plan)
{
  const double angle = axis.tail<3>().norm();
  return std::min(
      {max_step_to_prior_sd / std::sqrt(axis.dot(plan.prior_precision * axis)),
       max_step_to_radius * radiusOf(plan.displacement_metric),
       angle > 0.0 ? max_step_angle / angle : std::numeric_limits<double>::infinity()});
}

/** Makes secants about one mode. */
class SecantMaker {
public:
  SecantMaker(const SurfaceScorer& scorer,
              const Isometry3d& mode,
              const SurfaceScores& at_mode,
              double tau,
              const Matrix6d& score_covariance)
  : scorer_(scorer)
  , mode_(mode)
  , centre_(mode * scorer.centroid())
  , at_mode_(at_mode)
  , tau_(tau)
  , J_(score_covariance)
  , J_factor_(score_covariance)
  {}

  Secant
  along(const Vector6d& step, int direction)
  {
    evaluateAt(step, forward_);
    evaluateAt(-step, backward_);
    num_evaluations_ += 2;
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

  bool
  isClear(const Secant& secant) const
  {
    const double information =
        secant.difference.dot(J_factor_.solve(secant.difference));
    const double noise = J_factor_.solve(secant.noise).trace();
    return information > clear_to_threshold * noiseThreshold(J_, secant.noise) * noise;
  }

  int
  numEvaluations() const
  {
    return num_evaluations_;
  }

private:
  void
  evaluateAt(const Vector6d& step, SurfaceScores& scores)
  {
    scorer_.evaluate(movedBy(step, centre_, mode_), centre_, tau_, hints_, scores);
  }

  /** What Gauss-Newton at the mode does not predict of the points' differences. */
  PointScores
  unpredictedScores(const Vector6d& step) const
  {
    const Index num_points = scorer_.sourcePoints().cols();
    PointScores points;
    points.scores.resize(6, num_points);
    points.positions.resize(3, num_points);
    Index count = 0;
    for (Index i = 0; i < num_points; ++i) {
      const auto index = static_cast<std::size_t>(i);
      const bool both = forward_.active[index] && backward_.active[index];
      if (!forward_.active[index] && !backward_.active[index])
        continue;
      points.scores.col(count) =
          0.5 * (forward_.scores.col(i) - backward_.scores.col(i));
      const auto jacobian = at_mode_.jacobians.col(i);
      if (both)
        points.scores.col(count) -= jacobian * jacobian.dot(step);
      points.positions.col(count) = scorer_.sourcePoints().col(i);
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
  const Matrix6d& J_;
  Eigen::LDLT<Matrix6d> J_factor_;
  PatchHints hints_;
  SurfaceScores forward_{};
  SurfaceScores backward_{};
  int num_evaluations_ = 0;
};

/** Length of the step along an axis. */
double
lengthOf(const Vector6d& axis, double standard_deviation, const SecantPlan& plan)
{
  return std::min(
      longestStep(axis, plan),
      std::max(plan.min_displacement, step_to_posterior_sd * standard_deviation));
}

/** Whether two steps are so much alike, up to sign, that one secant does for both.
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
  for (int i = 0; i < max_shortenings && !maker.isClear(secant); ++i) {
    length *= step_shortening;
    if (length < shortest)
      break;
    secant = maker.along(length * axis, direction);
  }
  return maker.isClear(secant) ? secant : widest;
}

/** H of steps and differences, symmetrised. */
Matrix6d
curvatureOf(const Secants& secants)
{
  const Matrix6d products = secants.steps.transpose() * secants.differences;
  const Matrix6d inverse = secants.steps.inverse();
  return inverse.transpose() * (0.5 * (products + products.transpose())) * inverse;
}

} // namespace

Secants
measureSecants(const SurfaceScorer& scorer,
               const Isometry3d& mode,
               const SurfaceScores& at_mode,
               double tau,
               const SecantPlan& plan,
               const Secants& previous)
{
  const PrincipalAxes principal(plan.covariance, plan.displacement_metric);
  SecantMaker maker(scorer, mode, at_mode, tau, plan.score_covariance);
  const Matrix6d information = plan.covariance.inverse();
  Secants secants = previous;
  for (int k = 0; k < 6; ++k) {
    const Vector6d axis = principal.axes.col(k);
    const double length =
        lengthOf(axis, std::sqrt(std::max(0.0, principal.variances[k])), plan);
    const Vector6d step = length * axis;
    if (isNearly(step, previous.planned.col(k), information))
      continue;
    // Directions are in the order of their spread: those that the data do not hold come
    // last in every round, and what was tried on them need not be tried again.
    const double shortest = std::max(min_shortened * plan.min_displacement,
                                     previous.unclear_displacement[k]);
    const Secant secant = clearSecant(maker, axis, length, shortest, k);
    secants.unclear_displacement[k] = maker.isClear(secant) ? 0.0 : length;
    secants.planned.col(k) = step;
    secants.steps.col(k) = secant.step;
    secants.differences.col(k) = secant.difference;
    secants.noise[static_cast<std::size_t>(k)] = secant.noise;
  }
  secants.num_evaluations = maker.numEvaluations();
  secants.curvature = curvatureOf(secants);
  return secants;
}

} // namespace bayesian_icp
