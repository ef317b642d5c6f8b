#include "calibrated/modes/robust_mode.h"

#include "algebra/decompositions.h"
#include "geometry/principal_axes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

/** The scale of Tukey's weight is reduced by this factor in each step. */
constexpr double annealing = 0.65;

/** Re-weightings between two searches of correspondences. */
constexpr int num_reweightings = 2;

/** Weight of points against the prior: neighbours repeat each other. */
constexpr double points_to_prior = 0.2;

/** Annealing has ended when the scale is within this factor of the residuals'. */
constexpr double scale_tolerance = 1.001;

/** Point-to-point ICP: a step moves the points at most as far as their root mean square
 * radius, and turns them by at most so much [rad]. It ends at the greatest number of
 * steps, or where the points move less than a part of the noise. */
constexpr double max_point_rotation = 0.2;
constexpr int max_point_steps = 20;
constexpr double point_tolerance = 0.01;

/** Two fits are distinct if their residuals differ by this many standard deviations. */
constexpr double clear_deviations = 2.0;

struct NormalEquations {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

/** Normal equations of the linearised residuals u + j^T xi, weighted at \p xi. \p
 * linear was evaluated without robust weights. */
NormalEquations
reweighted(const SurfaceScores& linear, const Vector6d& xi, double tau)
{
  NormalEquations equations;
  for (Index i = 0; i < linear.residuals.size(); ++i) {
    if (!linear.has_patch[static_cast<std::size_t>(i)])
      continue;
    const Vector6d jacobian = linear.jacobians.col(i);
    const double residual = linear.residuals[i] + jacobian.dot(xi);
    const double weight = tukeyWeight(residual / (SurfaceScorer::tukey_constant * tau));
    if (weight == 0.0)
      continue;
    const Vector6d weighted = weight * jacobian;
    equations.information += weighted.lazyProduct(jacobian.transpose());
    equations.gradient += weight * residual * jacobian;
  }
  equations.information =
      Matrix6d(equations.information.selfadjointView<Eigen::Upper>()); // symmetric
  return equations;
}

/** One step, with fixed correspondences and new weights. */
Vector6d
stepFrom(const SurfaceScores& linear, double tau, const TwistPrior& prior)
{
  const double weight = points_to_prior / (tau * tau);
  Vector6d xi = Vector6d::Zero();
  for (int k = 0; k < num_reweightings; ++k) {
    const NormalEquations equations = reweighted(linear, xi, tau);
    const Matrix6d matrix = weight * equations.information + prior.precision;
    xi -= matrix.ldlt().solve(weight * equations.gradient + prior.gradient +
                              prior.precision * xi);
  }
  return xi;
}

} // namespace

Matrix6d
displacementMetric(const SurfaceScorer& scorer, const Isometry3d& T_target_source)
{
  const Eigen::Matrix3Xd arms =
      T_target_source.linear() *
      (scorer.leadingPoints(T_target_source).colwise() - scorer.centroid());
  const Eigen::Matrix3d moment =
      arms * arms.transpose() / static_cast<double>(arms.cols());
  Matrix6d metric = Matrix6d::Identity();
  metric.bottomRightCorner<3, 3>() =
      moment.trace() * Eigen::Matrix3d::Identity() - moment;
  return metric;
}

RobustFit
fitRobustly(const SurfaceScorer& scorer,
            const HeldPrior& prior,
            const Isometry3d& start,
            const RobustFitOptions& options)
{
  constexpr double no_weights = std::numeric_limits<double>::infinity();
  RobustFit fit;
  fit.pose = start;
  double scale = options.start_scale;
  PatchHints hints;
  SurfaceScores linear;
  for (int step = 0; step < options.max_steps; ++step) {
    const Vector3d centre = fit.pose * scorer.centroid();
    scorer.evaluate(fit.pose, centre, no_weights, hints, linear);
    fit.residual_scale = residualScale(linear);
    const double tau = std::max(fit.residual_scale, scale);
    const bool is_annealing = tau > scale_tolerance * fit.residual_scale;
    scale *= annealing;
    TwistPrior pull = twistPrior(prior, fit.pose, centre);
    pull.precision += options.hold;
    pull.gradient += options.hold * twistBetween(start, fit.pose, centre);
    const Vector6d xi = stepFrom(linear, tau, pull);
    if (!xi.allFinite())
      break;
    const Matrix6d metric = displacementMetric(scorer, fit.pose);
    fit.pose = movedBy(xi, centre, fit.pose);
    if (!is_annealing && xi.dot(metric * xi) < options.tolerance * options.tolerance)
      break;
  }
  scorer.evaluate(fit.pose, fit.pose * scorer.centroid(), no_weights, hints, linear);
  fit.residuals = cappedResiduals(linear);
  fit.cost = costOf(linear);
  fit.residual_scale = residualScale(linear);
  return fit;
}

RobustFit
fitAt(const SurfaceScorer& scorer, const HeldPrior& prior, const Isometry3d& pose)
{
  RobustFitOptions fit;
  fit.max_steps = 0;
  return fitRobustly(scorer, prior, pose, fit);
}

double
relativeCost(const RobustFit& a, const RobustFit& b)
{
  double sum_a = 0.0, sum_b = 0.0, sum_of_squares = 0.0;
  for (Index i = 0; i < a.residuals.size(); ++i) {
    const double difference = a.residuals[i] - b.residuals[i];
    if (std::isnan(difference))
      continue;
    sum_a += a.residuals[i];
    sum_b += b.residuals[i];
    sum_of_squares += difference * difference;
  }
  return std::abs(sum_a - sum_b) > clear_deviations * std::sqrt(sum_of_squares)
             ? sum_a / sum_b
             : a.cost / b.cost;
}

bool
isClearlyWorse(const RobustFit& a, const RobustFit& b, double margin)
{
  return a.cost > b.cost && relativeCost(a, b) >= 1.0 + margin;
}

RobustFit
fitPointToPoint(const SurfaceScorer& scorer,
                const HeldPrior& prior,
                const Isometry3d& start)
{
  const Index num_source = scorer.sourcePoints().cols();
  RobustFit fit;
  fit.pose = start;
  PatchHints hints(static_cast<std::size_t>(scorer.numPoints()), KdTree::none);
  // Of a squared distance against the prior [1/m^2].
  const double point_weight = 1.0 / (scorer.noise() * scorer.noise());
  for (int step = 0; step < max_point_steps; ++step) {
    const Vector3d centre = fit.pose * scorer.centroid();
    const TwistPrior pull = twistPrior(prior, fit.pose, centre);
    Vector6d gradient = pull.gradient;
    scorer.countQueries(scorer.numPoints());
    for (Index i = 0; i < scorer.numPoints(); ++i) {
      const SurfaceModel& model = scorer.modelOf(i);
      const Vector3d point = scorer.placeOf(i, fit.pose);
      auto& hint = hints[static_cast<std::size_t>(i)];
      hint = model.tree()
                 .nearest(
                     point.cast<float>(), std::numeric_limits<float>::infinity(), hint)
                 .index;
      if (hint == KdTree::none)
        continue;
      const Vector3d met = model.tree().points().col(hint).cast<double>();
      // What moves is the point, or else the surface that it meets.
      const Vector3d residual =
          i < num_source ? Vector3d(point - met) : fit.pose.linear() * (met - point);
      const Vector3d arm = i < num_source ? Vector3d(point + model.origin() - centre)
                                          : fit.pose * (met + model.origin()) - centre;
      gradient.head<3>() += point_weight * residual;
      gradient.tail<3>() += point_weight * arm.cross(residual);
    }
    const Matrix6d metric = displacementMetric(scorer, fit.pose);
    const Matrix6d matrix =
        point_weight * static_cast<double>(scorer.numPoints()) * metric +
        pull.precision;
    Vector6d xi = -matrix.ldlt().solve(gradient);
    if (!xi.allFinite())
      break;
    const double length = std::sqrt(xi.dot(metric * xi));
    const double excess = std::max(xi.head<3>().norm() / radiusOf(metric),
                                   xi.tail<3>().norm() / max_point_rotation);
    if (excess > 1.0)
      xi /= excess;
    fit.pose = movedBy(xi, centre, fit.pose);
    if (length < point_tolerance * scorer.noise())
      break;
  }
  return fit;
}

} // namespace bayesian_icp
