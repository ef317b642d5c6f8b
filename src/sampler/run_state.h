/** \file
 * \brief What the chains of one run share: threads, progress and cancellation.
 */
#pragma once

#include "threads/for_each_piece.h"

#include <bayesian_icp/draws.h>

#include <atomic>
#include <mutex>

namespace bayesian_icp {

/** \brief Progress and end of a run, for all its threads. */
class RunState {
public:
  explicit RunState(const ProgressCallback& progress, long total_steps = 0)
  : progress_(progress)
  , total_steps_(total_steps)
  {}

  /** \brief Makes the run longer; while no chain is sampling. */
  void
  addSteps(long more_steps)
  {
    total_steps_ += more_steps;
  }

  bool
  stopped() const
  {
    return stopped_;
  }

  bool
  cancelled() const
  {
    return cancelled_;
  }

  /** \brief Ends the run of all threads, which is not called cancelled. */
  void
  stop()
  {
    stopped_ = true;
  }

  /** \brief Counts a step of \p chain and tells the callback. While the run has
   * no length, the chain warms up, and the step is not counted.
   * \param[in] poseNow returns the pose at which the chain is; asked only if there is a
   *            callback */
  template <typename PoseFunction>
  void
  reportStep(int chain, long chain_steps, const PoseFunction& poseNow)
  {
    if (!progress_)
      return;
    if (total_steps_ == 0)
      return reportWarmUp(chain);
    const Vector6d pose = canonicalPose(poseNow());
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!stopped_ && !progress_({chain, chain_steps, ++steps_, total_steps_, pose}))
      cancelled_ = stopped_ = true;
  }

  /** \brief Tells the callback that \p chain still warms up. No step is counted. */
  void
  reportWarmUp(int chain)
  {
    if (!progress_)
      return;
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!stopped_ && !progress_({chain, 0, 0, 0}))
      cancelled_ = stopped_ = true;
  }

private:
  const ProgressCallback& progress_;
  long total_steps_;
  long steps_ = 0;
  std::atomic<bool> stopped_{false};
  std::atomic<bool> cancelled_{false};
  std::mutex mutex_;
};

/** \brief work(chain) for every chain; a thread owns whole chains. Rethrows the first
 * exception.
 * \param[in] num_threads as asked for, 0: as OpenMP would */
template <typename Work>
void
forEachChain(int num_chains, int num_threads, RunState& run, const Work& work)
{
  forEachPiece(num_chains, num_threads, [&](int i) {
    try {
      work(i);
    }
    catch (...) {
      run.stop();
      throw;
    }
  });
}

} // namespace bayesian_icp
