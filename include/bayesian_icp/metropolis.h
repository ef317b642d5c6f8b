/** \file
 * \brief Metropolis steps that use what the warm-up has learned.
 */
#pragma once

#include <bayesian_icp/gaussian_fit.h>
#include <bayesian_icp/sampling_chain.h>

namespace bayesian_icp {

/** \brief One chain of Metropolis-Hastings on StochasticEnergy::energy(): two proposals
 * from a multivariate t about the fitted Gaussian, then one random walk, and so on. The
 * first take the chain across the density, the last frees it from where the Gaussian is
 * far too low. */
class BAYESIAN_ICP_EXPORT MetropolisChain : public SamplingChain {
public:
  /** \p energy and \p random must outlive this object. */
  MetropolisChain(const Gaussian& gaussian,
                  const Vector6d& start,
                  StochasticEnergy& energy,
                  Random& random);

  void
  step() override;

  const Vector6d&
  position() const override;

  /** \brief Share of the independent proposals that were accepted so far, in [0, 1]. */
  double
  acceptance() const;

private:
  double
  proposalEnergy(const Vector6d& x) const;

  bool
  acceptWith(const Vector6d& proposal, double log_proposal_ratio);

  Gaussian gaussian_;
  StochasticEnergy& energy_;
  Random& random_;
  Vector6d position_;
  double position_energy_;
  long num_steps_ = 0;
  long num_independent_ = 0;
  long num_accepted_ = 0;
};

} // namespace bayesian_icp
