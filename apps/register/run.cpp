#include "register/run.h"

#include "register/configure.h"
#include "register/normalization.h"

#include <bayesian_icp/pose.h>

#include <pcl/registration/bayesian_icp.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <chrono>
#include <functional>

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

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

/** Aligns, passes on where ICP is, and measures ICP, which is first, and the estimate.
 * PCL calls back also as it is told to, before ICP has begun. */
void
align(const Eigen::Matrix4d& guess,
      const ProgressCallback& progress,
      const IcpCallback& icp_progress,
      Icp& icp,
      RegistrationResult& result)
{
  auto last_iteration = Clock::now();
  bool has_begun = false;
  std::function<Icp::UpdateVisualizerCallbackSignature> tell =
      [&](const Cloud&, const pcl::Indices&, const Cloud&, const pcl::Indices&) {
        if (icp_progress)
          icp_progress(has_begun ? icp.getFinalTransformation().cast<double>().eval()
                                 : guess);
        last_iteration = Clock::now();
        has_begun = true;
      };
  icp.registerVisualizationCallback(tell);
  icp.setProgressCallback(progress);
  const auto start = last_iteration = Clock::now();
  Cloud moved_source;
  icp.align(moved_source, guess.cast<float>());
  result.icp_seconds = Seconds(last_iteration - start).count();
  result.sampling_seconds = Seconds(Clock::now() - last_iteration).count();
}

} // namespace

Run
readRun(const std::string& source_file,
        const std::string& target_file,
        const Settings& settings)
{
  Run run;
  const auto start = Clock::now();
  run.source = io::readCloud(source_file);
  run.target = io::readCloud(target_file);
  run.reading_seconds = Seconds(Clock::now() - start).count();
  run.settings = settings;
  run.settings.options.prior.frame =
      priorFrameOf(settings.options, run.source.points.cast<double>());
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
  if (isNormalized(settings))
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
  result.chains = chainsOf(icp);
  result.is_final_the_mean = settings.use_mean && hasUsableMean(result.summary.status);
  result.final_matrix =
      result.is_final_the_mean ? matrixOf(result.summary.mean) : result.icp_matrix;
  return result;
}

void
registerClouds(const ProgressCallback& progress,
               Run& run,
               const IcpCallback& icp_progress)
{
  run.result = registerClouds(
      run.source.points, run.target.points, run.settings, progress, icp_progress);
}

} // namespace bayesian_icp::app
