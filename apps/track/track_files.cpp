#include "track/track_files.h"

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

/** With a covariance that can be inverted. Where a motion oblique to the axes is not
 * seen, and others are seen well, it is made wider: all variances by a little. */
PoseEstimate
invertibleEstimateOf(GaussianPose pose)
{
  constexpr double widening = 1e-10; // least eigenvalue of correlations
  PoseEstimate estimate = estimateOf(pose);
  if (!complaintAboutExport(estimate, true).empty()) {
    pose.covariance.diagonal() *= 1.0 + 2.0 * widening;
    estimate = estimateOf(pose);
  }
  return estimate;
}

template <typename LineOf>
std::string
linesOf(const Track& track, const LineOf& lineOf)
{
  std::string text;
  for (std::size_t k = 0; k < track.poses().size(); ++k) {
    ExportOptions options;
    options.timestamp_ns = std::llround(track.times()[k] * 1e9);
    text += lineOf(estimateOf(track.poses()[k]), options);
  }
  return text;
}

} // namespace

std::string
tumText(const Track& track)
{
  return linesOf(track, tumLine);
}

std::string
tumCovarianceText(const Track& track)
{
  return linesOf(track, tumCovarianceLine);
}

std::string
g2oText(const Track& track)
{
  std::string text;
  for (std::size_t k = 0; k < track.poses().size(); ++k)
    text += g2oVertex(matrixOf(track.poses()[k].mean), static_cast<int>(k));
  text += "FIX 0\n";
  for (const TrackStep& step : track.steps()) {
    std::vector<TrackEdge> edges = step.more_edges;
    edges.insert(edges.begin(), step.edge);
    for (const TrackEdge& edge : edges) {
      ExportOptions options;
      options.target_vertex = edge.target;
      options.source_vertex = step.scan;
      text += g2oEdge(invertibleEstimateOf(edge.pose), options);
    }
  }
  return text;
}

} // namespace bayesian_icp::app
