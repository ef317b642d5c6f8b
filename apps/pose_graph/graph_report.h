/** \file
 * \brief The report of a pose graph: the trajectory, and whether its edges agree.
 */
#pragma once

#include "pose_graph/graph_command.h"

#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief An edge that does not go with the others. */
struct Disagreement {
  /** Position in the edges. */
  std::size_t edge = 0;
  /** Of the edge against the optimized poses: isContradiction(), or no cycle closes. */
  double squared_error = 0.0;
  /** Number of its cycles, if none of them closes and there are more than one. */
  std::size_t num_open_cycles = 0;
};

/** \param[in] optimum of \p edges */
std::vector<Disagreement>
disagreementsOf(const std::vector<GraphEdge>& edges, const OptimizedPoses& optimum);

/** \brief A self-contained HTML page.
 * \param[in] optimum of the edges that \p graph has taken
 * \throws plot::GnuplotError if gnuplot does not draw */
std::string
graphReportHtml(const GraphCommand& command,
                const ScanGraph& graph,
                const OptimizedPoses& optimum);

} // namespace bayesian_icp::app
