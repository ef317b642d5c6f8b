/** \file
 * \brief The gradient that calibrated draws follow: weighted scores of batches, with a
 * control variate and a guard.
 */
#pragma once

#include "calibrated/draws/calibrated_draws.h"
#include "calibrated/draws/product_coordinates.h"
#include "sampler/mini_batch.h"
#include "sampler/stochastic_energy.h"

#include <vector>

namespace bayesian_icp {

/** \brief Gradient with respect to ProductCoordinates. Each chain has a copy. */
class WeightedScore : public StochasticGradient {
public:
  /** \p estimate and \p prior must outlive this object. */
  WeightedScore(const CalibratedEstimate& estimate,
                const HeldPrior& prior,
                BatchScore score);

  const ProductCoordinates&
  coordinates() const
  {
    return coordinates_;
  }

  /** \brief Number of points with a weight at the mode. Batches are drawn from these.
   */
  std::size_t
  numTerms() const
  {
    return active_.size();
  }

  /** \brief Let draws follow the shape of the data only in part: the difference between
   * the likelihood's gradient and that of a Gaussian is multiplied by \p gain. */
  void
  setShapeGain(const Matrix6d& gain)
  {
    shape_gain_ = gain;
  }

  /** \brief The gradient. A guard keeps both parts near those of Gaussians, so that a
   * chain always comes back. */
  SplitGradient
  gradient(const Vector6d& z, std::size_t batch_size, Random& random) override;

  /** \brief Covariance of a term's gradient as in StochasticEnergy, with n =
   * numTerms(), estimated from single points at draws of the calibrated Gaussian. */
  Matrix6d
  termCovariance(int num_positions, int num_points, Random& random);

private:
  Vector6d
  totalScore(const Vector6d& z, const std::vector<std::size_t>& batch);

  Vector6d
  guarded(const Vector6d& linear, const Vector6d& deviation) const;

  const CalibratedEstimate& estimate_;
  HeldPrior prior_;
  BatchScore score_;
  ProductCoordinates coordinates_;
  std::vector<std::size_t> active_;
  Matrix6d shape_gain_ = Matrix6d::Identity();
  MiniBatches batches_;
  PatchHints hints_;
};

} // namespace bayesian_icp
