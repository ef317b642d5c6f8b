/** \file
 * \brief A Markov chain in six dimensions, whatever its steps are: those of Algorithm 1
 * with the paper's RMSProp preconditioner (SgldChain), of a preconditioner that is
 * learned before and then frozen (LangevinChain), or of Metropolis (MetropolisChain).
 */
#pragma once

#include <bayesian_icp/export.h>
#include <bayesian_icp/pose.h>

namespace bayesian_icp {

/** \brief State of a chain that has a preconditioner and samples. */
class BAYESIAN_ICP_EXPORT SamplingChain {
public:
  virtual ~SamplingChain();

  /** \brief One step. */
  virtual void
  step() = 0;

  /** \brief Where the chain is, in the sampler's space. */
  virtual const Vector6d&
  position() const = 0;
};

} // namespace bayesian_icp
