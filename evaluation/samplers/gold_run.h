/** \file
 * \brief One of the runs behind a gold standard: chains that learn a walk together.
 */
#pragma once

#include "samplers/gold_standard.h"

#include <memory>
#include <utility>

namespace bayesian_icp::evaluate {

/** \brief Chains of one run and what they have learned. */
class GoldRun {
public:
  /** \param[in] target must outlive this object
   * \param[in] run number of the run: its random numbers */
  GoldRun(const GoldTarget& target, const GoldOptions& options, int run);

  /** \brief Random walks while the temperature falls to 1. */
  void
  anneal();

  /** \brief Mean energy of each chain in the last stage. */
  const Eigen::VectorXd&
  meanEnergies() const
  {
    return mean_energies_;
  }

  const Vector6d&
  position(int chain) const
  {
    return chains_[static_cast<std::size_t>(chain)].position();
  }

  void
  moveTo(int chain, const Vector6d& position)
  {
    chains_[static_cast<std::size_t>(chain)].moveTo(position);
  }

  /** \brief One round whose draws serve to fit proposals and are then forgotten; the
   * walk learns from them here.
   * \return positions of all chains, the first part of the round left out */
  PoseMatrix
  adapt();

  /** \brief Jump with these proposals from now on. */
  void
  setMixture(std::shared_ptr<const TMixture> mixture)
  {
    mixture_ = std::move(mixture);
  }

  /** \brief One round with the frozen proposals. */
  void
  sample();

  /** \brief Draws kept by sample(), a matrix a chain. */
  const std::vector<PoseMatrix>&
  draws() const
  {
    return draws_;
  }

  /** \brief Share of accepted mixture proposals in sample(), over all rounds. */
  double
  acceptance() const;

private:
  /** Positions after every second step of one stage. */
  std::vector<PoseMatrix>
  advance(int num_steps, double temperature);

  /** Proposals made and accepted, of each kind. */
  struct Counts {
    long walks = 0, accepted_walks = 0, jumps = 0, accepted_jumps = 0;
  };

  Counts
  advanceChain(MetropolisState& chain, double temperature, PoseMatrix& positions) const;

  void
  learnWalk(const std::vector<PoseMatrix>& positions);

  GoldOptions options_;
  std::vector<MetropolisState> chains_;
  Matrix6d walk_factor_;
  double walk_scale_ = 1.0;
  std::shared_ptr<const TMixture> mixture_;
  Eigen::VectorXd mean_energies_;
  std::vector<PoseMatrix> draws_;
  Counts counts_;
};

} // namespace bayesian_icp::evaluate
