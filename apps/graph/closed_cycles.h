/** \file
 * \brief What all cycles of a pose graph say together about its edges.
 */
#pragma once

#include "graph/cycle_closure.h"

#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief Probability below which a cycle is said not to close. */
constexpr double min_cycle_probability = 0.01;

/** \brief A cycle that says something, and how it closes. */
struct ClosedCycle {
  /** "0-1-2": from the direct edge's target along the path. */
  std::string vertices;
  Cycle cycle;
  Closure closure;

  /** \brief Number of edges. */
  std::size_t
  length() const
  {
    return cycle.path.size() + 1;
  }

  bool
  closes() const
  {
    return closure.probability >= min_cycle_probability;
  }
};

/** \brief The cycles of cyclesOf() whose closure has a degree of freedom. */
std::vector<ClosedCycle>
closedCycles(const std::vector<GraphEdge>& edges, std::size_t max_length);

/** \brief Cycles of one length, or all. */
struct CycleStatistics {
  /** The length, or "all". */
  std::string name;
  std::size_t num_cycles = 0;
  /** On average. */
  double num_degrees = 0.0;
  /** Sum of the squared errors by that of the degrees: 1 if the covariances are right.
   */
  double nees_per_degree = 0.0;
  /** Shares of the cycles in their 50 % and 95 % regions. */
  double share_in_half = 0.0;
  double share_in_95 = 0.0;
};

/** \brief A line for each length, and one for all. */
std::vector<CycleStatistics>
statisticsOf(const std::vector<ClosedCycle>& cycles);

/** \brief Cycles that do not close, the least probable first. */
std::vector<ClosedCycle>
openCycles(const std::vector<ClosedCycle>& cycles);

/** \brief An edge none of whose cycles closes. */
struct Suspect {
  /** Position in the graph's edges. */
  std::size_t edge = 0;
  std::size_t num_cycles = 0;
};

/** \brief Edges all of whose cycles fail to close, if they are in more than one. */
std::vector<Suspect>
suspectsOf(const std::vector<ClosedCycle>& cycles);

/** \brief What independent cycles say together. */
struct JointClosure {
  std::size_t num_cycles = 0;
  /** z^T C^-1 z: z are the errors of the closures along the directions that count, C is
   * their covariance with all that they have in common. */
  double squared_error = 0.0;
  int num_degrees = 0;
  /** chanceOf() both, to first order. */
  double probability = 1.0;
};

/** \brief Test all cycles at once, but for those that are sums of shorter ones.
 * \param[in] edges whose own noise is above 0
 * \param[in] cycles closedCycles() of them */
JointClosure
jointClosureOf(const std::vector<GraphEdge>& edges,
               const std::vector<ClosedCycle>& cycles);

} // namespace bayesian_icp::app
