#include "calibrated/calibrated_report.h"

#include "algebra/decompositions.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp {

namespace {

/** Number of independent patches for kappa_inf = kappa_48. */
constexpr double num_smallest_clusters = 96.0;

/** Starts converge only to a fraction of the noise. Ends within this fraction of it, as
 * root mean squared displacement, are one place. */
constexpr double start_to_noise = 0.5;

using Axes = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/** Variance of the posterior along \p twist in units of the prior's. */
double
shareOfPrior(const CalibratedEstimate& estimate, const Vector6d& twist)
{
  const double prior = twist.dot(estimate.prior.precision * twist);
  return prior / (prior + twist.dot(estimate.information * twist));
}

/** Motions that are independent of each other both in the posterior and in the prior.
 * The motions come first that the data determine best in comparison with the prior. */
Matrix6d
independentAxes(const CalibratedEstimate& estimate)
{
  const Matrix6d posterior_precision = estimate.information + estimate.prior.precision;
  Matrix6d axes = Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d>(
                      estimate.prior.precision, posterior_precision)
                      .eigenvectors();
  // All motions within the prior-only space are equivalent. A user can picture its
  // principal axes.
  Eigen::Index first = 6;
  while (first > 0 && !(shareOfPrior(estimate, axes.col(first - 1)) <
                        max_share_of_prior * max_share_of_prior))
    --first;
  const Axes free = axes.rightCols(6 - first);
  if (free.cols() > 1) {
    const Eigen::MatrixXd spread =
        free.transpose() * estimate.displacement_metric * free;
    axes.rightCols(6 - first) =
        free * Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(spread).eigenvectors();
  }
  return axes;
}

/** Share of the information along \p twist that is above its noise. */
double
shareAboveNoise(const CalibratedEstimate& estimate, const Vector6d& twist)
{
  const Vector6d score = estimate.curvature * twist;
  return twist.dot(estimate.information * twist) /
         score.dot(estimate.score_covariance.ldlt().solve(score));
}

Observability
observabilityOf(double above_noise, double share_of_prior)
{
  if (!(share_of_prior < max_share_of_prior))
    return Observability::PriorOnly;
  const bool is_observed = above_noise >= min_observed_share_above_noise &&
                           share_of_prior < max_observed_share_of_prior;
  return is_observed ? Observability::Observed : Observability::Weak;
}

DataDirection
directionAlong(const Vector6d& axis, const CalibratedEstimate& estimate)
{
  DataDirection direction;
  direction.twist = axis / std::sqrt(axis.dot(estimate.displacement_metric * axis));
  const Vector6d& twist = direction.twist;
  const double prior = twist.dot(estimate.prior.precision * twist);
  // Rounding may make zero slightly negative.
  const double data = std::max(0.0, twist.dot(estimate.information * twist));
  direction.standard_deviation = 1.0 / std::sqrt(prior + data);
  direction.prior_standard_deviation = 1.0 / std::sqrt(prior);
  direction.relative_information = data / prior;
  direction.observability = observabilityOf(shareAboveNoise(estimate, twist),
                                            std::sqrt(shareOfPrior(estimate, twist)));
  direction.description = describeTwist(twist, estimate.centre);
  return direction;
}

std::vector<DataDirection>
directionsOf(const CalibratedEstimate& estimate)
{
  const Matrix6d axes = independentAxes(estimate);
  std::vector<DataDirection> directions;
  directions.reserve(6);
  for (int k = 0; k < 6; ++k)
    directions.push_back(directionAlong(axes.col(k), estimate));
  std::stable_sort(directions.begin(),
                   directions.end(),
                   [](const DataDirection& a, const DataDirection& b) {
                     return a.standard_deviation < b.standard_deviation;
                   });
  return directions;
}

/** Motions that the prior alone holds, one per column. */
Axes
freeAxes(const std::vector<DataDirection>& directions)
{
  Axes free(6, 0);
  for (const DataDirection& direction : directions)
    if (direction.observability == Observability::PriorOnly) {
      free.conservativeResize(6, free.cols() + 1);
      free.rightCols<1>() = direction.twist;
    }
  return free;
}

/** Least squared length of \p twist in \p metric after any motion along \p free. */
double
squaredLengthBeyond(const Axes& free, const Vector6d& twist, const Matrix6d& metric)
{
  double squared = twist.dot(metric * twist);
  if (free.cols() > 0) {
    const Eigen::VectorXd part = free.transpose() * metric * twist;
    squared -= part.dot((free.transpose() * metric * free).ldlt().solve(part));
  }
  return squared < 0.0 ? 0.0 : squared;
}

/** Mahalanobis distance of the two ends. They may differ by a fraction of the noise,
 * and freely along motions that the prior alone holds. */
double
basinDistance(const CalibratedEstimate& estimate, const DataReport& report)
{
  const double tolerance = start_to_noise * report.noise_scale;
  const Matrix6d spread =
      estimate.covariance +
      tolerance * tolerance * estimate.displacement_metric.inverse();
  return std::sqrt(squaredLengthBeyond(
      freeAxes(report.directions), estimate.other_end, spread.inverse()));
}

/** Probability that a chi-square variate of \p degrees of freedom is above \p x. */
double
chiSquareTail(int degrees, double x)
{
  double tail = degrees % 2 == 0 ? 0.0 : std::erfc(std::sqrt(0.5 * x));
  for (int k = degrees % 2; k < degrees; k += 2)
    tail +=
        std::pow(0.5 * x, 0.5 * k) * std::exp(-0.5 * x) / std::tgamma(0.5 * k + 1.0);
  return tail;
}

/** See DataReport::prior_probability. The directions are independent both in the prior
 * and in the posterior. Along each of them, the posterior's mean deviates from the
 * prior's by a variance that is the prior's, less the posterior's: the prior pulls the
 * mean towards its own. */
double
priorProbability(const CalibratedEstimate& estimate,
                 const std::vector<DataDirection>& directions)
{
  const Vector6d deviation = estimate.prior.deviation + estimate.mean;
  int num_held = 0;
  double squared = 0.0;
  for (const DataDirection& direction : directions) {
    if (direction.observability == Observability::PriorOnly)
      continue;
    const double z = direction.twist.dot(estimate.prior.precision * deviation) *
                     direction.prior_standard_deviation;
    squared += z * z * (1.0 + 1.0 / direction.relative_information);
    ++num_held;
  }
  return std::min(num_held > 0 ? chiSquareTail(num_held, squared) : 1.0,
                  chiSquareTail(6, estimate.better_fit));
}

} // namespace

DataReport
dataReportOf(const CalibratedEstimate& estimate, double noise)
{
  DataReport report;
  report.is_available = true;
  report.residual_scale = estimate.residual_scale;
  report.noise_scale = estimate.residual_scale * noise;
  report.effective_patches =
      num_smallest_clusters * std::max(1.0, estimate.kappa_48) / estimate.kappa_inf;
  const ActiveShares active = activeSharesOf(estimate.scores);
  report.active_fraction = active.source;
  report.active_fraction_of_target = active.target;
  report.correlation_factor = estimate.kappa_inf;
  report.degrees_of_freedom = estimate.degrees_of_freedom;
  report.other_cost_ratio = estimate.other_cost_ratio;
  report.centre = estimate.centre;
  report.directions = directionsOf(estimate);
  report.basin_distance = basinDistance(estimate, report);
  report.prior_probability = priorProbability(estimate, report.directions);
  report.flags = flagsOf(report);
  return report;
}

} // namespace bayesian_icp
