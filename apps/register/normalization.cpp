#include "register/normalization.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp::app {

namespace {

/** Largest |x|, |y|, |z| of the finite points [m]. */
float
largestCoordinate(const Eigen::Matrix3Xf& points)
{
  float largest = 0.0F;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    if (points.col(i).allFinite())
      largest = std::max(largest, points.col(i).cwiseAbs().maxCoeff());
  return largest;
}

void
scaleMode(const Vector6d& factors, Vector6d& mean, Matrix6d& covariance)
{
  mean = factors.cwiseProduct(mean);
  covariance = factors.asDiagonal() * covariance * factors.asDiagonal();
}

/** Every convention's error is scaled alike: translations and the translational part of
 * twists, in whichever frame. */
void
scaleSummary(double unit, Summary& summary)
{
  Vector6d factors;
  factors << unit, unit, unit, 1.0, 1.0, 1.0;
  summary.mean = factors.cwiseProduct(summary.mean);
  for (Matrix6d& covariance : summary.covariances)
    covariance = factors.asDiagonal() * covariance * factors.asDiagonal();
  for (Mode& mode : summary.modes)
    scaleMode(factors, mode.mean, mode.covariance);
  for (std::size_t k = 0; k < 3; ++k) {
    CoordinateSummary& coordinate = summary.coordinates[k];
    for (double* length : {&coordinate.mean,
                           &coordinate.standard_deviation,
                           &coordinate.quantile_2_5,
                           &coordinate.median,
                           &coordinate.quantile_97_5,
                           &coordinate.mcse})
      *length *= unit;
  }
}

void
scaleResult(double unit, RegistrationResult& result)
{
  result.icp_matrix.topRightCorner<3, 1>() *= unit;
  result.final_matrix.topRightCorner<3, 1>() *= unit;
  // The largest number stands for a fitness that is not defined.
  if (result.icp_fitness < std::numeric_limits<double>::max())
    result.icp_fitness *= unit * unit;
  for (Chain& chain : result.chains)
    chain.draws.leftCols<3>() *= unit;
  scaleSummary(unit, result.summary);
}

/** \p progress, told of poses in metres; empty if it is. */
ProgressCallback
inMetres(double unit, const ProgressCallback& progress)
{
  if (!progress)
    return progress;
  return [unit, &progress](const Progress& scaled) {
    Progress state = scaled;
    state.pose.head<3>() *= unit;
    return progress(state);
  };
}

IcpCallback
inMetres(double unit, const IcpCallback& icp_progress)
{
  if (!icp_progress)
    return icp_progress;
  return [unit, &icp_progress](Eigen::Matrix4d T_target_source) {
    T_target_source.topRightCorner<3, 1>() *= unit;
    icp_progress(T_target_source);
  };
}

} // namespace

bool
isNormalized(const Settings& settings)
{
  return settings.is_normalized && settings.options.preset == Preset::Paper;
}

RegistrationResult
registerNormalized(const Eigen::Matrix3Xf& source,
                   const Eigen::Matrix3Xf& target,
                   const Settings& settings,
                   const ProgressCallback& progress,
                   const IcpCallback& icp_progress)
{
  const float largest = std::max(largestCoordinate(source), largestCoordinate(target));
  const float unit = largest > 0.0F ? largest : 1.0F;
  Settings scaled = settings;
  scaled.is_normalized = false;
  scaled.scaleLengths(1.0 / double(unit));
  RegistrationResult result = registerClouds(source / unit,
                                             target / unit,
                                             scaled,
                                             inMetres(unit, progress),
                                             inMetres(unit, icp_progress));
  scaleResult(double(unit), result);
  return result;
}

} // namespace bayesian_icp::app
