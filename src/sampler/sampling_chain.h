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
  virtual const Vector6d&
  position() const = 0;

  /** \brief Whether the chain is so far out that it has to be stopped; by default, if
   * it is not finite. */
  virtual bool
  hasDiverged() const
  {
    return !position().allFinite();
  }
};

} // namespace bayesian_icp
