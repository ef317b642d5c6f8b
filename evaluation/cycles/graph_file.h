/** \file
 * \brief Edges of a pose graph from a file in g2o's format.
 */
#pragma once

#include <bayesian_icp/pose.h>

#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief An EDGE_SE3:QUAT: the pose of one vertex as seen from another. */
struct GraphEdge {
  int target = 0;
  int source = 0;
  Eigen::Matrix4d T_target_source = Eigen::Matrix4d::Identity();
  /** CovarianceConvention::RightSE3 [m, rad]. */
  Matrix6d covariance = Matrix6d::Identity();
};

/** \brief Read the edges of a file, in their order. Other lines are left out. The
 * information of g2o is that of half angles.
 * \throws io::FileError if the file cannot be read, has no edges, or has one that is
 *         not complete, not finite, or without a positive definite information */
std::vector<GraphEdge>
readGraph(const std::string& file);

} // namespace bayesian_icp::evaluate
