/** \file
 * \brief The gradient that calibrated draws follow: weighted scores of batches, with a
 * control variate and a guard.
 */
#pragma once

#include <bayesian_icp/calibration/calibrated_draws.h>
#include <bayesian_icp/calibration/product_coordinates.h>
#include <bayesian_icp/stochastic_energy.h>

#include <vector>

namespace bayesian_icp {

/** \brief What the chains' scores have in common. */
struct WeightedScoreModel {
  /** All must outlive this object. */
  WeightedScoreModel(const CalibratedEstimate& estimate, const Prior& prior);

  const CalibratedEstimate& estimate;
  const Prior& prior;
  ProductCoordinates coordinates;
  /** Points that have a weight at the mode: those that batches are drawn from. */
  std::vector<std::size_t> active;
};

/** \brief Gradient with respect to ProductCoordinates, for one chain. */
class WeightedScore : public StochasticGradient {
public:
  /** \p model must outlive this object. */
  WeightedScore(const WeightedScoreModel& model, BatchScore score);

  /** \brief Follow the shape of the data only in part: the difference between the
   * likelihood's gradient and that of a Gaussian is multiplied by \p gain. */
  void
  setShapeGain(const Matrix6d& gain)
  {
    shape_gain_ = gain;
  }

  /** \brief The gradient whose likelihood part differs from that of a Gaussian
   * likelihood by no more than would keep a chain from coming back. */
  SplitGradient
  gradient(const Vector6d& z, std::size_t batch_size, Random& random) override;

  /** \brief Covariance of a term's gradient as in StochasticEnergy, n = active.size(),
   * from single points at draws of the calibrated Gaussian. */
  Matrix6d
  termCovariance(int num_positions, int num_points, Random& random);

private:
  const std::vector<std::size_t>&
  drawBatch(std::size_t size, Random& random);

  Vector6d
  totalScore(const Vector6d& z, const std::vector<std::size_t>& batch);

  Vector6d
  guarded(const Vector6d& z, const Vector6d& likelihood) const;

  const WeightedScoreModel& model_;
  BatchScore score_;
  Matrix6d shape_gain_ = Matrix6d::Identity();
  std::vector<std::size_t> shuffled_;
  std::vector<std::size_t> batch_;
};

} // namespace bayesian_icp
