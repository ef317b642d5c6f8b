/** \file
 * \brief Interface of a Markov chain in six dimensions. The implementations are
 * Algorithm 1 with the paper's RMSProp preconditioner (SgldChain), Langevin steps with
 * a frozen preconditioner (LangevinChain), and Metropolis steps (MetropolisChain).
 */
#pragma once

#include <bayesian_icp/pose.h>

namespace bayesian_icp {

/** \brief State of a Markov chain. */
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

} // namespace bayesian_icp
