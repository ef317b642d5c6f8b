/** \file
 * \brief Charts of a trajectory: where it leads, and how sure that is.
 */
#pragma once

#include "graph/pose_graph.h"
#include "report/chart.h"

#include <utility>
#include <vector>

namespace bayesian_icp::app {

/** \brief Poses in the frame of scan 0. */
struct PathData {
  std::vector<GaussianPose> poses;
  /** The same as they were known before something; may be empty. */
  std::vector<GaussianPose> before;
  /** Positions in poses, to be joined by lines. */
  std::vector<std::pair<int, int>> loops;
};

inline constexpr const char* path_colour = chart_colours[0];
inline constexpr const char* ellipse_colour = chart_colours[1];
inline constexpr const char* loop_colour = chart_colours[2];
inline constexpr const char* before_colour = quiet_colour;

/** \brief Positions along the two axes along which the trajectory is longest, with 95 %
 * regions of \p path.poses, of which there is at least one. */
Chart
pathChart(const PathData& path);

/** \brief Standard deviations of position and rotation in the frame of scan 0.
 * \param[in] x one number of each pose
 * \param[in] x_label what \p x is, with its unit */
std::vector<Chart>
deviationCharts(const std::vector<double>& x,
                const std::string& x_label,
                const PathData& path);

/** \brief A small chart of lines.
 * \param[in] script gnuplot's settings and plot command */
Chart
lineChart(const std::string& id,
          const std::string& caption,
          const std::string& x_label,
          const std::string& y_label,
          const std::string& script);

} // namespace bayesian_icp::app
