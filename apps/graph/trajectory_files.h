/** \file
 * \brief Trajectories and pose graphs in the files of other software.
 */
#pragma once

#include "graph/pose_graph.h"

#include <cstdint>
#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief TUM trajectory: a line of each pose.
 * \param[in] times of at least as many poses [ns] */
std::string
tumText(const std::vector<std::int64_t>& times, const std::vector<GaussianPose>& poses);

/** \brief The covariances of tumText(), in CovarianceConvention::R3xSO3. */
std::string
tumCovarianceText(const std::vector<std::int64_t>& times,
                  const std::vector<GaussianPose>& poses);

/** \brief A graph in g2o's format: VERTEX_SE3:QUAT of each pose, FIX 0, EDGE_SE3:QUAT
 * of each edge, with invertibleCovariance(). */
std::string
g2oText(const std::vector<GaussianPose>& poses, const std::vector<GraphEdge>& edges);

/** \brief Read the EDGE_SE3:QUAT of a file in g2o's format, in their order. Other lines
 * are left out. The information of g2o is that of half angles.
 * \throws io::FileError if the file cannot be read, has no edges, or has one that is
 *         not complete, not finite, or without a positive definite information */
std::vector<GraphEdge>
readGraph(const std::string& file);

/** \brief The covariance, if it can be inverted. Where a motion oblique to the axes is
 * not seen, and others are seen well, it is made wider: all variances by a little.
 * \param[in] covariance CovarianceConvention::RightSE3 */
Matrix6d
invertibleCovariance(const Matrix6d& covariance);

} // namespace bayesian_icp::app
