/** \file
 * \brief A pose graph of consecutive scans, registered to each other.
 */
#pragma once

#include "batch/batch_run.h"

#include <bayesian_icp/exports.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace bayesian_icp::app {

/** \brief What the graph is to be made of. */
struct GraphRequest {
  /** Files of the scans, in their order. */
  std::vector<std::string> scans;
  /** Target and source, positions in scans, of edges in addition to those of the chain.
   */
  std::vector<std::pair<int, int>> loops;
  /** The guess is that of each scan's pose in the frame of the one before. */
  Settings settings;
  /** Whether the prior takes the place of a registration of the chain that is of no
   * use. */
  bool has_weak_edges = false;
};

/** \brief Registrations on their way to a graph. Vertex k is the pose of scan k in the
 * frame of scan 0. */
class ScanGraph {
public:
  /** \param[in] tell gets, for each edge, whether all is well and a line of text, by
   * one thread at a time */
  ScanGraph(const GraphRequest& request,
            const std::function<void(bool, const std::string&)>& tell);

  /** \brief Register each scan to the one before, then the loops, whose guesses are
   * from the chain of mean poses. Both may end early after an interrupt.
   *
   * An edge of the chain has the posterior, prior included; one of a loop has it
   * without the prior, which is about what the chain says already. */
  void
  registerScans();

  /** \brief The graph in g2o's format: VERTEX_SE3:QUAT, FIX 0, EDGE_SE3:QUAT. */
  std::string
  g2oText() const;

  /** \brief Number of registrations whose status is not Ok, or whose edge is missing.
   */
  int
  numNotOk() const
  {
    return num_not_ok_;
  }

private:
  BatchPair
  pairOf(int target, int source) const;

  /** Register pairs (target, source) and note their edges, in their order. */
  void
  registerPairs(const std::vector<std::pair<int, int>>& indices, bool are_loops);

  /** The edge of a registration; none, and a word about it, if that is of no use. */
  std::optional<PoseEstimate>
  edgeOf(const BatchResult& result, bool is_loop);

  void
  chainPoses();

  const GraphRequest& request_;
  std::function<void(bool, const std::string&)> tell_;
  std::vector<Eigen::Matrix4d> poses_;
  /** Edges of the chain, then those of the loops. */
  std::vector<std::optional<PoseEstimate>> edges_;
  int num_not_ok_ = 0;
};

} // namespace bayesian_icp::app
