#include "viewer/live_state.h"

namespace bayesian_icp::viewer {

namespace {

void
thinOut(ChainTrack& track)
{
  std::size_t kept = 0;
  for (std::size_t i = 1; i < track.trace.size(); i += 2)
    track.trace[kept++] = track.trace[i];
  track.trace.resize(kept);
  track.steps_between *= 2;
}

} // namespace

void
LiveState::moveIcp(const Eigen::Matrix4d& T_target_source)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  state_.icp_matrix = T_target_source;
  state_.icp_iterations += has_icp_begun_;
  has_icp_begun_ = true;
}

bool
LiveState::moveChain(const Progress& progress)
{
  if (!progress.pose.allFinite())
    return !is_stopped_;
  const Eigen::Vector3d position =
      rotationOf(progress.pose) * reference_ + progress.pose.head<3>();
  const std::lock_guard<std::mutex> lock(mutex_);
  state_.steps = progress.steps;
  state_.total_steps = progress.total_steps;
  const auto chain = static_cast<std::size_t>(progress.chain);
  if (state_.chains.size() <= chain)
    state_.chains.resize(chain + 1);
  ChainTrack& track = state_.chains[chain];
  track.pose = progress.pose;
  if (progress.chain_steps % track.steps_between == 0)
    track.trace.push_back(position);
  if (track.trace.size() > max_trace_length)
    thinOut(track);
  return !is_stopped_;
}

LiveSnapshot
LiveState::snapshot() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return state_;
}

} // namespace bayesian_icp::viewer
