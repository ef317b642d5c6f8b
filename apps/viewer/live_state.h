/** \file
 * \brief Where ICP and the chains of a running registration are, for another thread to
 * look at.
 */
#pragma once

#include <bayesian_icp/draws.h>

#include <atomic>
#include <mutex>
#include <vector>

namespace bayesian_icp::viewer {

/** \brief The way of one chain. */
struct ChainTrack {
  /** Where it is now [m, rad]. */
  Vector6d pose = Vector6d::Zero();
  /** Where the reference point has been, target frame [m]: evenly spaced steps. */
  std::vector<Eigen::Vector3d> trace;
  long steps_between = 1;
};

struct LiveSnapshot {
  Eigen::Matrix4d icp_matrix = Eigen::Matrix4d::Identity();
  int icp_iterations = 0;
  long steps = 0;
  long total_steps = 0;
  /** Of the chains that have begun, by their number; others have no trace. */
  std::vector<ChainTrack> chains;
};

/** \brief Longest trace that is kept; of longer ones every other point is dropped. */
constexpr std::size_t max_trace_length = 1000;

/** \brief Written by the registration, read by the view. */
class LiveState {
public:
  /** \brief \p reference is the point of the source to be traced [m]. */
  explicit LiveState(const Eigen::Vector3d& reference) : reference_(reference) {}

  /** \brief ICP is here: at its start, and after each iteration. */
  void
  moveIcp(const Eigen::Matrix4d& T_target_source);

  /** \brief A chain has made a step. \return whether to go on */
  bool
  moveChain(const Progress& progress);

  LiveSnapshot
  snapshot() const;

  /** \brief Ask the registration to end. */
  void
  stop()
  {
    is_stopped_ = true;
  }

private:
  Eigen::Vector3d reference_;
  mutable std::mutex mutex_;
  LiveSnapshot state_;
  bool has_icp_begun_ = false;
  std::atomic<bool> is_stopped_{false};
};

} // namespace bayesian_icp::viewer
