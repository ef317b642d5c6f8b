/** \file
 * \brief What a run tells while it samples, and what a chain leaves behind.
 */
#pragma once

#include <bayesian_icp/pose.h>

#include <functional>
#include <limits>

namespace bayesian_icp {

/** \brief State of a run, as told to a progress callback. */
struct Progress {
  /** Chain that has just made a step, and its steps so far. */
  int chain;
  long chain_steps;
  /** Steps of all chains so far, and of the complete run. Both are 0 while preset
   * `calibrated` makes its estimate and while the chains of `exact` warm up: how many
   * steps they need is not known before, and more are added if the draws have not
   * mixed. */
  long steps;
  long total_steps;
  /** Canonical pose at which the chain is now [m, rad]; NaN while nothing is sampled.
   * Preset `calibrated` adjusts the spread of its draws when all are there, by a factor
   * of at most 1.4 in any direction, and makes them Student's t: its chains are shown
   * here before that. */
  Vector6d pose = Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
};

/** \brief Called after each step, by one thread at a time, not always the same one.
 * Returns false to cancel the run. An exception stops the run and reaches the caller.
 */
using ProgressCallback = std::function<bool(const Progress&)>;

/** \brief Draws of one chain. */
struct Chain {
  /** Kept draws, one canonical pose a row. Shorter than asked for if the chain diverged
   * or the run was cancelled. */
  PoseMatrix draws;
  /** Whether the chain was stopped because it ran away or became non-finite, or jumped
   * by more than half a turn in most of its steps. */
  bool diverged = false;
};

} // namespace bayesian_icp
