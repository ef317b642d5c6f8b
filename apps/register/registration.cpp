#include "register/registration.h"

#include "register/configure.h"
#include "register/normalization.h"

#include <bayesian_icp/pose.h>

#include <pcl/registration/bayesian_icp.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <chrono>

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

/** Passes on where ICP is. PCL calls back also as it is told to, before ICP has begun.
 */
void
observeIcp(const IcpCallback& icp_progress, const Eigen::Matrix4d& guess, Icp& icp)
{
  if (!icp_progress)
    return;
  std::function<Icp::UpdateVisualizerCallbackSignature> tell =
      [&icp, icp_progress, guess, has_begun = false](const Cloud&,
                                                     const pcl::Indices&,
                                                     const Cloud&,
                                                     const pcl::Indices&) mutable {
        icp_progress(has_begun ? icp.getFinalTransformation().cast<double>().eval()
                               : guess);
        has_begun = true;
      };
  icp.registerVisualizationCallback(tell);
}

/** Aligns, and measures ICP and sampling, which begins with the first step of a chain.
 */
void
align(const Eigen::Matrix4d& guess,
      const ProgressCallback& progress,
      Icp& icp,
      RegistrationResult& result)
{
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;
  const auto start = Clock::now();
  Clock::time_point first_step = Clock::time_point::max();
  icp.setProgressCallback([&](const Progress& state) {
    first_step = std::min(first_step, Clock::now());
    return progress(state);
  });
  Cloud moved_source;
  icp.align(moved_source, guess.cast<float>());
  const auto end = Clock::now();
  first_step = std::min(first_step, end);
  result.icp_seconds = Seconds(first_step - start).count();
  result.sampling_seconds = Seconds(end - first_step).count();
}

} // namespace

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
  observeIcp(icp_progress, settings.guess, icp);
  RegistrationResult result;
  align(settings.guess, progress, icp, result);
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

} // namespace bayesian_icp::app
