/** \file
 * \brief A Markov chain in six dimensions, whatever its steps are: those of Algorithm 1
 * with the paper's RMSProp preconditioner (SgldChain), of a preconditioner that is
 * learned before and then frozen (LangevinChain), or of Metropolis (MetropolisChain).
 */
#pragma once

#include <bayesian_icp/export.h>
#include <bayesian_icp/pose.h>

namespace bayesian_icp {

/** \brief A chain in the middle of its steps. */
class BAYESIAN_ICP_EXPORT SamplingChain {
public:
  virtual ~SamplingChain() = default;

  /** \brief One step. */
  virtual void
  step() = 0;

  /** \brief Where the chain is, in the sampler's space. */
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
