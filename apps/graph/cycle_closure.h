/** \file
 * \brief Does a way around through a pose graph end where it began?
 */
#pragma once

#include "graph/pose_graph.h"

#include <map>
#include <utility>
#include <vector>

namespace bayesian_icp::app {

/** \brief An edge, and another way between its vertices. */
struct Cycle {
  /** Positions in the graph's edges. */
  std::size_t direct = 0;
  /** From the direct edge's target to its source; an edge may be taken backwards. */
  std::vector<std::size_t> path;

  /** \brief The positions of all its edges, in ascending order. */
  std::vector<std::size_t>
  members() const;
};

/** \brief For each edge but those that the paths need, the shortest way around: fewest
 * edges, each at most \p max_length - 1 of them; of several the one of the first edges
 * in the file.
 * \param[in] max_length of a cycle, the direct edge included; at least 3 */
std::vector<Cycle>
cyclesOf(const std::vector<GraphEdge>& edges, std::size_t max_length);

/** \brief A way along edges, to first order. */
struct Way {
  /** The vertex at its end. */
  int end = 0;
  /** The end in the frame of the begin. */
  Eigen::Matrix4d T_begin_end = Eigen::Matrix4d::Identity();
  /** CovarianceConvention::RightSE3 of what is not common to all edges [m, rad]. */
  Matrix6d own = Matrix6d::Zero();
  /** Factors of the noise that is. */
  CommonFactors common = CommonFactors::Zero();

  /** \brief Go on along an edge from the end; it may be taken backwards. Its error is
   * taken as independent of those before but for what all edges have in common: the
   * noise of a scan between two edges would cancel in part. */
  void
  append(const GraphEdge& edge);

  /** \brief Of T_begin_end, CovarianceConvention::RightSE3 [m, rad]. */
  Matrix6d
  covariance() const;
};

/** \brief The way from vertex \p begin on.
 * \param[in] path positions in \p edges, each of which may be taken backwards */
Way
wayAlong(const std::vector<GraphEdge>& edges,
         int begin,
         const std::vector<std::size_t>& path);

/** \brief How well a cycle closes. */
struct Closure {
  /** Twist from the direct edge to the way, in the frame of its source [m, rad]. */
  Vector6d error = Vector6d::Zero();
  /** error^T S^-1 error, S the sum of the edges' covariances, carried to that frame. */
  double squared_error = 0.0;
  /** Directions in which S is below max_deviation^2. */
  int num_degrees = 6;
  /** chanceOf() both. */
  double probability = 1.0;
};

/** \brief That a larger \p squared_error comes of chance: chi-square with
 * \p num_degrees; 1 without degrees. */
double
chanceOf(double squared_error, int num_degrees);

/** \brief Standard deviation of a closure from which on a direction says nothing [m,
 * rad]: there an edge has no information of the clouds. */
constexpr double max_deviation = 3.0;

/** \brief Whose a noise is: of an edge alone, of all edges of one scan, or of all
 * edges. */
enum class NoiseOf { Edge, Scan, Common };

/** \brief Six independent standard normal numbers; and the position of the edge, the
 * vertex, or the column of what all edges share. */
using Noise = std::pair<NoiseOf, long>;

/** \brief An error as a sum over noises, each times its factor. */
using ErrorTerms = std::map<Noise, Matrix6d>;

/** \brief The error of a cycle's closure, to first order. */
ErrorTerms
errorTermsOf(const std::vector<GraphEdge>& edges, const Cycle& cycle);

/** \brief Of an error. */
Matrix6d
covarianceOf(const ErrorTerms& terms);

/** \brief Close a cycle, to first order. Errors have in common what
 * GraphEdge::shared says. */
Closure
closureOf(const std::vector<GraphEdge>& edges, const Cycle& cycle);

} // namespace bayesian_icp::app
