/** \file
 * \brief The one sampling loop: burn-in, thinning, keeping, reporting and cancelling
 * are the same for every SamplingChain.
 */
#pragma once

#include "sampler/run_state.h"

#include <bayesian_icp/options.h>

#include <functional>

namespace bayesian_icp {

/** \brief State of a Markov chain in six dimensions. The implementations are Algorithm
 * 1 with the paper's RMSProp preconditioner (SgldChain), Langevin steps with a frozen
 * preconditioner (LangevinChain), and Metropolis steps (MetropolisChain). */
class SamplingChain {
public:
  virtual ~SamplingChain() = default;

  /** \brief Do one step. */
  virtual void
  step() = 0;

  /** \brief Position of the chain in the sampler's space. */
  const Vector6d&
  position() const
  {
    return position_;
  }

  /** \brief Whether the chain is so far out that it has to be stopped; by default, if
   * it is not finite. */
  virtual bool
  hasDiverged() const
  {
    return !position_.allFinite();
  }

protected:
  explicit SamplingChain(const Vector6d& start) : position_(start) {}

  Vector6d position_;
};

/** \brief Steps of one chain, and which of them are kept. */
struct Schedule {
  int num_burn_in = 0;
  int thinning = 1;
  int num_draws = 0;

  /** \brief Steps from the start, or from where this number of draws is there. */
  long
  numSteps(long num_kept = 0) const
  {
    return num_burn_in + thinning * (num_draws - num_kept);
  }
};

/** \brief The results of one chain. */
struct Path {
  /** Kept positions in the sampler's space, one per column. */
  Eigen::Matrix<double, 6, Eigen::Dynamic> positions{6, 0};
  long num_steps = 0;
  bool has_diverged = false;
};

/** \brief The pose of a position in the sampler's space. */
using ToPose = std::function<Vector6d(const Vector6d& position)>;

/** \brief Steps of all chains, whose schedules differ in their draws only. */
long
numStepsOf(const ChainOptions& chains, int num_burn_in, int thinning);

/** \brief Let a chain make its steps, until all are made, the chain has diverged or the
 * run is stopped.
 * \param[in,out] sampler from where it is
 * \param[in] schedule its draws include those that \p path has already
 * \param[in] to_pose for the report
 * \param[in] chain its number in the report
 * \param[in,out] run is told of every step
 * \param[in,out] path is extended */
void
advance(SamplingChain& sampler,
        const Schedule& schedule,
        const ToPose& to_pose,
        int chain,
        RunState& run,
        Path& path);

/** \brief The poses of the positions of \p path, canonical. */
Chain
chainOf(const Path& path, const ToPose& to_pose);

} // namespace bayesian_icp
