/** \file
 * \brief Metropolis steps with proposals that were learned before and are now frozen.
 */
#pragma once

#include "sampler/sampling.h"
#include "sampler/stochastic_energy.h"
#include "sampler/t_mixture.h"

#include <memory>

namespace bayesian_icp {

/** \brief What chains propose. */
struct MetropolisProposal {
  /** Proposal of jumps. It does not depend on the position of the chain. */
  TMixture jumps;
  /** F of a random walk x + F z, where z is standard normal. */
  Matrix6d walk_factor;
};

/** \brief One chain of Metropolis-Hastings on StochasticEnergy::fullEnergy(). It
 * alternates a random walk and a jump. Jumps take the chain across the density. Walks
 * free it from places where the mixture is far too low. */
class MetropolisChain : public SamplingChain {
public:
  /** \p energy and \p random must outlive this object. */
  MetropolisChain(const Vector6d& start, StochasticEnergy& energy, Random& random);

  /** \brief Set the proposal of step(). */
  void
  setProposal(std::shared_ptr<const MetropolisProposal> proposal);

  /** \brief Do one step. A proposal must be set. */
  void
  step() override;

  /** \brief Do one random walk with \p factor or, with a probability of 1/2, with 0.3
   * of it, which is accepted where the density is rough. \param[in] factor L of the
   * step L z, where z is standard normal \param[in] temperature the density is exp(-U /
   * temperature) \return whether the walk was accepted */
  bool
  walk(const Matrix6d& factor, double temperature);

  bool
  hasDiverged() const override
  {
    return energy_.hasDiverged(position_);
  }

  /** \brief Share of accepted walks in step() since setProposal(), in [0, 1]. */
  double
  walkAcceptance() const
  {
    return walks_.acceptance();
  }

  /** \brief Share of accepted jumps in step() since setProposal(), in [0, 1]. */
  double
  jumpAcceptance() const
  {
    return jumps_.acceptance();
  }

private:
  struct Count {
    long proposed = 0, accepted = 0;

    void
    add(bool is_accepted)
    {
      ++proposed;
      accepted += is_accepted ? 1 : 0;
    }

    double
    acceptance() const
    {
      return proposed > 0
                 ? static_cast<double>(accepted) / static_cast<double>(proposed)
                 : 0.0;
    }
  };

  bool
  jump();

  bool
  acceptWith(const Vector6d& proposal, double log_proposal_ratio, double temperature);

  StochasticEnergy& energy_;
  Random& random_;
  std::shared_ptr<const MetropolisProposal> proposal_;
  double position_energy_;
  bool is_jump_next_ = false;
  Count walks_, jumps_;
};

} // namespace bayesian_icp
