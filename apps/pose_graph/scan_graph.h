/** \file
 * \brief A pose graph of consecutive scans, registered to each other.
 */
#pragma once

#include "batch/batch_run.h"
#include "graph/cycle_closure.h"

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace bayesian_icp::app {

/** \brief What the graph is to be made of. */
struct GraphRequest {
  /** Files of the scans, in their order. */
  std::vector<std::string> scans;
  /** Each scan is registered to so many scans before it. */
  int span = 1;
  /** Target and source, positions in scans, of more edges. */
  std::vector<std::pair<int, int>> loops;
  /** Radius of loopCandidates() [m]; 0: none are looked for. */
  double loop_radius = 0.0;
  /** The guess is that of each scan's pose in the frame of the one before. */
  Settings settings;
  /** Normal of the plane in which the sensor moves, in its frame: that of a 2-D laser
   * scanner's scans. None: it moves in space. */
  std::optional<Eigen::Vector3d> plane_normal;
  /** Whether the prior takes the place of a registration of the chain that is of no
   * use. */
  bool has_weak_edges = false;
};

/** \brief Why two scans are registered. */
enum class EdgeKind {
  /** They are consecutive. */
  Chain,
  /** There are few scans between them: GraphRequest::span. */
  Span,
  /** GraphRequest::loops. */
  Named,
  /** The trajectory comes back: GraphRequest::loop_radius. */
  Found
};

/** \brief "chain", or the option that asks for it. */
const char*
toString(EdgeKind kind);

/** \brief A registration and what became of it. */
struct ScanEdge {
  EdgeKind kind = EdgeKind::Chain;
  /** Without pose and covariance if there is no posterior of use. */
  GraphEdge edge;
  bool is_in_graph = false;
  /** Motions that the clouds do not determine, 0 to 6, but those out of the sensor's
   * plane; 0 without a posterior of use. */
  int num_unmeasured = 0;
  /** Of the registration's status; names the motions that the prior alone holds. */
  std::string message;
  /** Why it is not in the graph, or what is wrong with it; empty if all is well. */
  std::string complaint;
  /** Of a loop and the chain between its scans. */
  std::optional<Closure> closure;
  double seconds = 0.0;

  /** \brief Whether it is to join distant parts of the chain. */
  bool
  isLoop() const
  {
    return kind == EdgeKind::Named || kind == EdgeKind::Found;
  }
};

/** \brief "3-7": the target, then the source. */
std::string
nameOf(const GraphEdge& edge);

/** \brief Registrations, and the graph that they make. Vertex k is the pose of scan k
 * in the frame of scan 0. */
struct ScanGraph {
  /** All: the chain, then the others. */
  std::vector<ScanEdge> registrations;
  /** The poses along the chain. Where an edge is missing, the prior takes its place. */
  std::vector<GaussianPose> chain;

  /** \brief The registrations that are in the graph. */
  std::vector<ScanEdge>
  taken() const;

  /** \brief Edges of the chain that leave a motion to the prior. */
  std::size_t
  numUnmeasured() const;
};

/** \brief Register each scan to the one before, then all others, whose priors are from
 * the chain of mean poses. Both may end early after an interrupt.
 *
 * An edge of the chain has the posterior, prior included; another one has it without
 * the prior, which is about what the chain says already. A loop that was found is in
 * the graph only if its status is ok and it closes with the chain. \param[in] tell
 * gets, for each edge, whether all is well and a line of text, by one thread at a time
 */
ScanGraph
registerScans(const GraphRequest& request,
              const std::function<void(bool, const std::string&)>& tell);

} // namespace bayesian_icp::app
