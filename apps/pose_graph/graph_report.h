/** \file
 * \brief The report of a pose graph: the trajectory, and whether its edges agree.
 */
#pragma once

#include "pose_graph/graph_command.h"

#include <string>

namespace bayesian_icp::app {

/** \brief A self-contained HTML page.
 * \param[in] optimum,cycles of the edges that \p graph has taken
 * \throws plot::GnuplotError if gnuplot does not draw */
std::string
graphReportHtml(const GraphCommand& command,
                const ScanGraph& graph,
                const OptimizedPoses& optimum,
                const std::vector<ClosedCycle>& cycles);

} // namespace bayesian_icp::app
