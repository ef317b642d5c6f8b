/** \file
 * \brief What a run reports while it samples, and the draws of a chain.
 */
#pragma once

#include <bayesian_icp/pose.h>

#include <functional>
#include <limits>

namespace bayesian_icp {

/** \brief State of a run, as a progress callback receives it. */
struct Progress {
  /** Chain that has just made a step, and its steps so far. */
  int chain;
  long chain_steps;
  /** Steps of all chains so far, and of the complete run. Both are 0 while preset
   * `calibrated` makes its estimate and while the chains of `exact` warm up, because
   * the number of steps is not known in advance. More steps are added if the draws have
   * not mixed. */
  long steps;
  long total_steps;
  /** Current canonical pose of the chain [m, rad]; NaN while nothing is sampled. Preset
   * `calibrated` adjusts the spread of its complete draws, by a factor of at most 1.4
   * in any direction, and makes them Student's t. The poses here are those before that.
   */
  Vector6d pose = Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
};

/** \brief Called after each step, by one thread at a time, not always the same one.
 * Returns false to cancel the run. An exception stops the run and reaches the caller.
 */
using ProgressCallback = std::function<bool(const Progress&)>;

/** \brief Draws of one chain. */
struct Chain {
  /** Kept draws; each row is one canonical pose. Fewer than requested if the chain
   * diverged or the run was cancelled. */
  PoseMatrix draws;
  /** Whether the chain was stopped because it ran away or became non-finite, or jumped
   * by more than half a turn in most of its steps. */
  bool diverged = false;
};

} // namespace bayesian_icp
