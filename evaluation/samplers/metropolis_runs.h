/** \file
 * \brief Metropolis-Hastings chains on an energy -log density in six dimensions: the
 * moves of the gold standard, and random walk and Langevin (MALA) as competitors.
 */
#pragma once

#include "sampler/t_mixture.h"

#include <bayesian_icp/pose.h>
#include <bayesian_icp/random.h>

#include <functional>

namespace bayesian_icp::evaluate {

/** \brief U(x) = -log density up to a constant. May remember what makes it faster, but
 * its value depends on x alone; one object serves one chain. */
using EnergyFunction = std::function<double(const Vector6d&)>;

/** \brief U(x), and its gradient into the second argument. */
using GradientFunction = std::function<double(const Vector6d&, Vector6d&)>;

/** \brief Position and energy of a chain. */
class MetropolisState {
public:
  MetropolisState(const Vector6d& start, EnergyFunction energy, Random random);

  /** \brief Random walk, proposal x + factor z with z standard normal, at the given
   * temperature. */
  bool
  walk(const Matrix6d& factor, double temperature = 1.0);

  /** \brief Proposal from \p mixture, wherever the chain is. */
  bool
  jump(const TMixture& mixture);

  /** \brief Put the chain elsewhere. */
  void
  moveTo(const Vector6d& position);

  const Vector6d&
  position() const
  {
    return position_;
  }

  double
  energy() const
  {
    return current_energy_;
  }

  Random&
  random()
  {
    return random_;
  }

private:
  bool
  accept(const Vector6d& proposal, double log_proposal_ratio, double temperature);

  EnergyFunction energy_;
  Random random_;
  Vector6d position_;
  double current_energy_;
};

/** \brief Random-walk Metropolis with a fixed proposal covariance factor factor^T. */
PoseMatrix
runRandomWalk(const Vector6d& start,
              const EnergyFunction& energy,
              const Matrix6d& factor,
              int num_steps,
              Random& random);

/** \brief Metropolis-adjusted Langevin steps of size \p step, preconditioned by
 * factor factor^T, \p factor lower triangular. */
PoseMatrix
runMala(const Vector6d& start,
        const GradientFunction& energy,
        const Matrix6d& factor,
        double step,
        int num_steps,
        Random& random);

} // namespace bayesian_icp::evaluate
