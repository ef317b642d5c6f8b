#include "register/run.h"

#include "io/clocks.h"
#include "register/configure.h"

#include <bayesian_icp/pose.h>

#include <pcl/registration/bayesian_icp.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <algorithm>

namespace bayesian_icp::app {

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Icp = pcl::BayesianIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>;

Cloud::Ptr
cloudOf(const Eigen::Matrix3Xf& points)
{
  Cloud::Ptr cloud(new Cloud);
  cloud->reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    cloud->push_back({points(0, i), points(1, i), points(2, i)});
  cloud->is_dense = points.allFinite();
  return cloud;
}

std::vector<Chain>
chainsOf(const Icp& icp)
{
  std::vector<Chain> chains;
  for (int i = 0; i < icp.getSummary().num_chains; ++i) {
    const auto index = static_cast<std::size_t>(i);
    chains.push_back({icp.getChain(index), icp.hasChainDiverged(index)});
  }
  return chains;
}

/** Aligns, passes on where ICP is, and measures ICP, which is first, and the estimate.
 * PCL calls back also as it is told to, before ICP has begun. */
void
align(const Eigen::Matrix4d& guess,
      const ProgressCallback& progress,
      const IcpCallback& icp_progress,
      Icp& icp,
      RegistrationResult& result)
{
  double last_iteration = io::wallSeconds();
  bool has_begun = false;
  std::function<Icp::UpdateVisualizerCallbackSignature> tell =
      [&](const Cloud&, const pcl::Indices&, const Cloud&, const pcl::Indices&) {
        if (icp_progress)
          icp_progress(has_begun ? icp.getFinalTransformation().cast<double>().eval()
                                 : guess);
        last_iteration = io::wallSeconds();
        has_begun = true;
      };
  icp.registerVisualizationCallback(tell);
  icp.setProgressCallback(progress);
  const double start = last_iteration = io::wallSeconds();
  Cloud moved_source;
  icp.align(moved_source, guess.cast<float>());
  result.icp_seconds = last_iteration - start;
  result.sampling_seconds = io::wallSeconds() - last_iteration;
}

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

/** Every convention's error is scaled alike: translations and the translational part of
 * twists, in whichever frame. */
void
scaleSummary(double unit, Summary& summary)
{
  const Vector6d factors(unit, unit, unit, 1.0, 1.0, 1.0);
  summary.mean = factors.cwiseProduct(summary.mean);
  const auto scale = [&](std::array<Matrix6d, 4>& covariances) {
    for (Matrix6d& covariance : covariances)
      covariance = factors.asDiagonal() * covariance * factors.asDiagonal();
  };
  scale(summary.covariances);
  for (Mode& mode : summary.modes) {
    mode.mean = factors.cwiseProduct(mode.mean);
    scale(mode.covariances);
  }
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
  const Vector6d factors(unit, unit, unit, 1.0, 1.0, 1.0);
  const Prior& prior = result.prior;
  result.prior = Prior(factors.cwiseProduct(prior.mean()),
                       factors.cwiseAbs2().cwiseProduct(prior.variance()),
                       unit * prior.referencePoint());
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

/** As registerClouds(), with both clouds divided by their largest coordinate; the
 * results, and what the callbacks are told, are in metres again. */
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

} // namespace

Run
readRun(const std::string& source_file,
        const std::string& target_file,
        const Settings& settings)
{
  Run run;
  const double start = io::wallSeconds();
  run.source = io::readCloud(source_file);
  run.target = io::readCloud(target_file);
  run.reading_seconds = io::wallSeconds() - start;
  run.settings = settings;
  run.settings.scaleToClouds(
      run.source.num_finite,
      std::max(run.source.largest_coordinate, run.target.largest_coordinate));
  return run;
}

RegistrationResult
registerClouds(const Eigen::Matrix3Xf& source,
               const Eigen::Matrix3Xf& target,
               const Settings& settings,
               const ProgressCallback& progress,
               const IcpCallback& icp_progress)
{
  if (settings.isNormalized())
    return registerNormalized(source, target, settings, progress, icp_progress);
  Icp icp;
  configure(settings, icp);
  icp.setInputSource(cloudOf(source));
  icp.setInputTarget(cloudOf(target));
  RegistrationResult result;
  align(settings.guess, progress, icp_progress, icp, result);
  result.icp_has_converged = icp.hasConverged();
  result.icp_matrix = icp.getFinalTransformation().cast<double>();
  result.icp_fitness = icp.getFitnessScore();
  result.summary = icp.getSummary();
  result.prior = icp.getPrior();
  result.chains = chainsOf(icp);
  result.is_final_the_mean = settings.use_mean && hasUsableMean(result.summary.status);
  result.final_matrix =
      result.is_final_the_mean ? matrixOf(result.summary.mean) : result.icp_matrix;
  return result;
}

} // namespace bayesian_icp::app
