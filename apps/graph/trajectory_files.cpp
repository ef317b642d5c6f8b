#include "graph/trajectory_files.h"

#include <bayesian_icp/exports.h>
#include <bayesian_icp/measurement.h>

#include <cmath>
#include <cstdint>

namespace bayesian_icp::app {

namespace {

PoseEstimate
estimateOf(const GaussianPose& pose)
{
  PoseEstimate estimate = bayesian_icp::estimateOf(
      pose.mean, pose.covariance, CovarianceConvention::RightSE3);
  estimate.status = Status::Ok;
  return estimate;
}

template <typename LineOf>
std::string
linesOf(const std::vector<double>& times,
        const std::vector<GaussianPose>& poses,
        const LineOf& lineOf)
{
  std::string text;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    ExportOptions options;
    options.timestamp_ns = std::llround(times.at(k) * 1e9);
    text += lineOf(estimateOf(poses[k]), options);
  }
  return text;
}

} // namespace

std::string
tumText(const std::vector<double>& times, const std::vector<GaussianPose>& poses)
{
  return linesOf(times, poses, tumLine);
}

std::string
tumCovarianceText(const std::vector<double>& times,
                  const std::vector<GaussianPose>& poses)
{
  return linesOf(times, poses, tumCovarianceLine);
}

std::string
g2oText(const std::vector<GaussianPose>& poses, const std::vector<GraphEdge>& edges)
{
  std::string text;
  for (std::size_t k = 0; k < poses.size(); ++k)
    text += g2oVertex(matrixOf(poses[k].mean), static_cast<int>(k));
  text += "FIX 0\n";
  for (const GraphEdge& edge : edges) {
    ExportOptions options;
    options.target_vertex = edge.target;
    options.source_vertex = edge.source;
    const GaussianPose pose{poseOf(edge.T_target_source),
                            invertibleCovariance(edge.covariance)};
    text += g2oEdge(estimateOf(pose), options);
  }
  return text;
}

Matrix6d
invertibleCovariance(const Matrix6d& covariance)
{
  constexpr double widening = 1e-10; // least eigenvalue of correlations
  const PoseEstimate estimate = estimateOf({Vector6d::Zero(), covariance});
  Matrix6d wider = covariance;
  if (!complaintAboutExport(estimate, true).empty())
    wider.diagonal() *= 1.0 + 2.0 * widening;
  return wider;
}

} // namespace bayesian_icp::app
