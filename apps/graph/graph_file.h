/** \file
 * \brief Edges of a pose graph from a file in g2o's format.
 */
#pragma once

#include "graph/pose_graph.h"

#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief Read the EDGE_SE3:QUAT of a file, in their order. Other lines are left out.
 * The information of g2o is that of half angles. \throws io::FileError if the file
 * cannot be read, has no edges, or has one that is not complete, not finite, or without
 * a positive definite information */
std::vector<GraphEdge>
readGraph(const std::string& file);

} // namespace bayesian_icp::app
