/** \file
 * \brief Registrations of pairs of a recording, by several methods, as edges of a
 * graph.
 */
#pragma once

#include "graph/pose_graph.h"
#include "study/recordings.h"
#include "study/run_file.h"

#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Which registration. */
struct EdgeName {
  std::string recording;
  std::uint64_t seed = 0;
  int target = 0, source = 0;
  std::string method;
  /** Hash of the points and the guess. */
  std::string inputs;
};

/** \brief What a method says about two scans. */
struct EdgeRun {
  static constexpr int num_name_columns = 6;

  EdgeName name;
  /** Empty, or why there is no edge; \p mean is then where the registration began. */
  std::string complaint;
  /** T_target_source (x, y, z, roll, pitch, yaw) [m, rad]. */
  Vector6d mean = Vector6d::Zero();
  /** CovarianceConvention::RightSE3 [m, rad]; its upper triangle counts. */
  Matrix6d covariance = Matrix6d::Zero();
  double seconds = 0.0;

  template <typename Column>
  void
  columns(const Column& column)
  {
    column("recording", name.recording);
    column("seed", name.seed);
    column("target", name.target);
    column("source", name.source);
    column("method", name.method);
    column("inputs", name.inputs);
    column("complaint", complaint);
    coordinateColumns("mean_", mean, column);
    for (int row = 0, k = 0; row < 6; ++row)
      for (int place = row; place < 6; ++place, ++k)
        column("covariance_" + io::textOf(k), covariance(row, place));
    column("seconds", seconds);
  }
};

/** \brief The edges that are in a file. */
using EdgeFile = RunFile<EdgeRun>;

/** \brief The edge, in the graph's form. */
app::GraphEdge
graphEdgeOf(const EdgeRun& run);

/** \brief `calibrated`: the preset with the default prior about the guess, taken out
 * again; `gicp`: PCL's GICP and the inverse of its Hessian; `closed-form`:
 * point-to-plane ICP with the prior, and Censi's covariance. The last two register at
 * most 5000 points. */
inline const std::vector<std::string> edge_methods = {
    "calibrated", "gicp", "closed-form"};

/** \brief Which pairs of a recording are registered: each scan to those up to \p span
 * before it, and each fifth one to the nearest one that is at least ten scans before it
 * and within \p closure_distance [m], by the true poses; 0: none. */
std::vector<std::pair<int, int>>
pairsOf(const Recording& recording, int span, double closure_distance);

/** \brief Deviations of guessOf(). */
constexpr AxisDeviation guess_sd = {0.1, 0.03};

/** \brief Where all methods begin: the true pose with independent errors of each axis,
 * as an odometry has them; by the names of recording and scans.
 * \param[in] seed of the study */
Eigen::Isometry3d
guessOf(const Recording& recording, std::uint64_t seed, int target, int source);

/** \brief Register two scans in one thread. */
EdgeRun
registeredEdge(const EdgeName& name,
               const Eigen::Matrix3Xd& source,
               const Eigen::Matrix3Xd& target,
               const Eigen::Isometry3d& guess);

} // namespace bayesian_icp::evaluate
