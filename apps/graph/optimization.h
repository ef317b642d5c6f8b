/** \file
 * \brief The most likely poses of a pose graph, and how well they are known.
 */
#pragma once

#include "graph/closed_cycles.h"

#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief How edges that contradict the others are treated. */
enum class RobustLoss {
  /** All edges count as their covariances say. */
  None,
  /** An edge pulls no harder than at the border of its 95 % region. */
  Huber,
  /** Beyond that border an edge pulls less and less. */
  Cauchy
};

/** \brief Short name: "none", "huber", "cauchy". */
const char*
toString(RobustLoss loss);

/** \brief What came of an optimisation. */
struct OptimizedPoses {
  /** Empty if it has converged, and all poses have covariances. */
  std::string complaint;
  /** In the frame of the first one, which is fixed, with the covariances of the errors
   * that edges leave. */
  std::vector<GaussianPose> poses;
  /** Of each edge, r^T S^-1 r of r = twistFrom() it, without any loss; chi-square with
   * 6 degrees for a graph in which nothing else is known. */
  std::vector<double> squared_errors;
};

/** \brief Twist from an edge to the poses of its vertices, in the frame of its source
 * [m, rad]. */
Vector6d
twistFrom(const GraphEdge& edge, const std::vector<GaussianPose>& poses);

/** \brief Whether an edge contradicts the others: its squared error is above the 99.9 %
 * quantile of chi-square with 6 degrees of freedom. */
constexpr bool
isContradiction(double squared_error)
{
  return squared_error > 22.457744;
}

/** \brief Minimise the sum of r^T S^-1 r over the edges, or of a robust loss of it
 * (Grisetti et al. 2010, eq. 3), by Ceres. One thread; the same input gives the same
 * bits.
 *
 * Errors have in common what GraphEdge::shared says. What all edges have in common
 * counts in the covariances of the poses and does not move them, because how it adds up
 * over edges is not known well enough to be estimated: edges are weighed without it,
 * and the covariances are those of these poses (Tapley, Schutz and Born 2004,
 * Statistical Orbit Determination, chapter 6: consider covariance).
 *
 * \param[in] poses to begin with, T_0_k of vertex k; at least 1
 * \param[in] edges between vertices 0 to poses.size() - 1, with positive definite
 *            covariances
 * \param[in] loss how edges that contradict the others are treated
 *
 * \throws std::invalid_argument if an edge is of other vertices, or its covariance is
 * not positive definite, or if no edges join a vertex to vertex 0; std::bad_alloc */
OptimizedPoses
optimizedPoses(const std::vector<Eigen::Matrix4d>& poses,
               const std::vector<GraphEdge>& edges,
               RobustLoss loss);

/** \brief An edge that contradicts the others. */
struct Disagreement {
  /** Position in the edges. */
  std::size_t edge = 0;
  /** Against the optimized poses. */
  double squared_error = 0.0;
  /** Number of its cycles, if none of them closes: suspectsOf(). A wrong edge that
   * pulls the poses along has a small squared error. */
  std::size_t num_open_cycles = 0;
};

/** \brief Edges with isContradiction(), or none of whose cycles closes.
 * \param[in] cycles closedCycles() of the edges, of any length
 * \param[in] optimum of the same edges */
std::vector<Disagreement>
disagreementsOf(const std::vector<ClosedCycle>& cycles, const OptimizedPoses& optimum);

} // namespace bayesian_icp::app
