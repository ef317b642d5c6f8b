/** \file
 * \brief The report of a pose graph: the trajectory, and whether its edges agree.
 */
#pragma once

#include "graph/optimization.h"
#include "pose_graph/scan_graph.h"

#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief A self-contained HTML page.
 * \param[in] optimum,cycles of the edges that \p graph has taken
 * \param[in] command that made the graph, as a shell takes it
 * \throws plot::GnuplotError if gnuplot does not draw */
std::string
graphReportHtml(const ScanGraph& graph,
                const OptimizedPoses& optimum,
                const std::vector<ClosedCycle>& cycles,
                const std::string& command);

} // namespace bayesian_icp::app
