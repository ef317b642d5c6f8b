#include <bayesian_icp/calibration/calibrated_report.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace bayesian_icp {

namespace {

/** Clusters of the score for kappa_inf = kappa_48: independent patches, at least. */
constexpr double num_smallest_clusters = 96.0;

Observability
observabilityOf(double keep, double share_of_prior)
{
  if (!(keep > 0.0) || !(share_of_prior < max_share_of_prior))
    return Observability::PriorOnly;
  const bool is_observed =
      keep >= min_observed_keep && share_of_prior < max_observed_share_of_prior;
  return is_observed ? Observability::Observed : Observability::Weak;
}

/** Standard deviations of the coordinates along the columns of \p directions. */
Vector6d
deviationsAlong(const Matrix6d& directions, const Matrix6d& covariance)
{
  const Matrix6d to_coordinates = directions.inverse();
  return (to_coordinates * covariance * to_coordinates.transpose())
      .diagonal()
      .cwiseAbs()
      .cwiseSqrt();
}

std::vector<DataDirection>
directionsOf(const CalibratedEstimate& estimate)
{
  const Vector6d deviations = deviationsAlong(estimate.directions, estimate.covariance);
  std::vector<DataDirection> directions(6);
  for (int k = 0; k < 6; ++k) {
    DataDirection& direction = directions[static_cast<std::size_t>(k)];
    direction.twist = estimate.directions.col(k);
    direction.standard_deviation = deviations[k];
    direction.prior_standard_deviation =
        1.0 /
        std::sqrt(direction.twist.dot(estimate.prior.precision * direction.twist));
    direction.relative_information = estimate.relative_information[k];
    direction.observability = observabilityOf(
        estimate.keep[k], deviations[k] / direction.prior_standard_deviation);
    direction.description = describeTwist(direction.twist, estimate.centre);
  }
  std::stable_sort(directions.begin(),
                   directions.end(),
                   [](const DataDirection& a, const DataDirection& b) {
                     return a.standard_deviation < b.standard_deviation;
                   });
  return directions;
}

DataFlags
flagsOf(const DataReport& report)
{
  DataFlags flags;
  flags.wrong_basin = !(report.basin_distance <= max_basin_distance);
  flags.low_support = !(report.active_fraction >= min_active_fraction);
  flags.few_patches = !(report.effective_patches >= min_effective_patches);
  flags.misfit = !(report.residual_scale <= max_residual_scale &&
                   report.correlation_factor <= max_correlation_factor);
  return flags;
}

} // namespace

DataReport
dataReportOf(const CalibratedEstimate& estimate,
             std::size_t num_source_points,
             double target_noise)
{
  const Matrix6d posterior_precision = estimate.information + estimate.prior.precision;
  DataReport report;
  report.is_available = true;
  report.residual_scale = estimate.residual_scale;
  report.noise_scale = estimate.residual_scale * target_noise;
  report.effective_patches =
      num_smallest_clusters * estimate.kappa_48 / estimate.kappa_inf;
  report.active_fraction = static_cast<double>(estimate.scores.num_active) /
                           static_cast<double>(num_source_points);
  report.correlation_factor = estimate.kappa_inf;
  report.basin_distance = std::sqrt(
      std::abs(estimate.other_end.dot(posterior_precision * estimate.other_end)));
  report.centre = estimate.centre;
  report.directions = directionsOf(estimate);
  report.flags = flagsOf(report);
  return report;
}

} // namespace bayesian_icp
