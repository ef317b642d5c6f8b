/** \file
 * \brief PoseEnergy as the sampler's StochasticEnergy: batches of source points,
 * burn-in by stochastic Gauss-Newton.
 */
#pragma once

#include "exact/pose_energy.h"
#include "sampler/mini_batch.h"
#include "sampler/stochastic_energy.h"

#include <functional>

namespace bayesian_icp {

/** \brief What the chains' energies have in common besides the PoseEnergy. */
struct PoseChainSettings {
  /** Centre [m, rad] and standard deviation of the starts, centred pose. */
  Vector6d start_centre;
  Vector6d start_spread;
  /** Source points on which energies are compared. */
  std::vector<std::size_t> fixed_batch;
  std::function<bool(const Vector6d& theta)> has_diverged;
};

/** \brief Energy of one chain, in the centred pose. */
class ChainPoseEnergy : public StochasticEnergy {
public:
  /** Both arguments must outlive this object. */
  ChainPoseEnergy(const PoseEnergy& pose_energy, const PoseChainSettings& settings);

  std::size_t
  numTerms() const override;

  SplitGradient
  gradient(const Vector6d& phi, std::size_t batch_size, Random& random) override;

  Matrix6d
  termCovariance(const Vector6d& phi, Random& random) override;

  Matrix6d
  roughCurvature(const Vector6d& phi) override;

  Matrix6d
  priorPrecision() const override;

  double
  energy(const Vector6d& phi) override;

  double
  fullEnergy(const Vector6d& phi) override;

  Vector6d
  toPose(const Vector6d& phi) const override;

  Vector6d
  drawStart(Random& random) override;

  Vector6d
  burnIn(const Vector6d& start, Random& random) override;

  double
  initialTemperature(const Vector6d& phi, const Matrix6d& covariance) override;

  bool
  hasDiverged(const Vector6d& phi) const override;

private:
  double
  energyOf(const std::vector<std::size_t>& batch, const Vector6d& phi);

  BatchTerms
  terms(const Vector6d& phi,
        const std::vector<std::size_t>& batch,
        BatchTerms::Extras extras);

  const PoseEnergy& pose_energy_;
  const PoseChainSettings& settings_;
  Matrix6d prior_precision_;
  std::vector<std::size_t> all_points_;
  EnergyWorkspace workspace_;
  MiniBatches batches_;
};

} // namespace bayesian_icp
