/** \file
 * \brief The Gaussian nearest to a density, learned from noisy gradients. It gives the
 * sampler its mean and preconditioner.
 */
#pragma once

#include "sampler/stochastic_energy.h"

#include <functional>

namespace bayesian_icp {

/** \brief A Gaussian in the form the sampler needs. */
class Gaussian {
public:
  Gaussian() = default;

  /** \param[in] mean of the Gaussian
   * \param[in] precision symmetric, positive definite */
  Gaussian(const Vector6d& mean, const Matrix6d& precision);

  /** \brief mean + L z with z standard normal. */
  Vector6d
  draw(Random& random) const
  {
    return mean_ + factor_ * random.normal6();
  }

  /** \brief -log density, without the constant 3 log(2 pi). */
  double
  energy(const Vector6d& x) const;

  const Vector6d&
  mean() const
  {
    return mean_;
  }

  const Matrix6d&
  precision() const
  {
    return precision_;
  }

  /** \brief L, covariance = L L^T; upper triangular. */
  const Matrix6d&
  factor() const
  {
    return factor_;
  }

  Matrix6d
  covariance() const
  {
    return factor_ * factor_.transpose();
  }

  /** \brief L^-1. */
  const Matrix6d&
  inverseFactor() const
  {
    return inverse_factor_;
  }

private:
  Vector6d mean_ = Vector6d::Zero();
  Matrix6d precision_ = Matrix6d::Identity();
  Matrix6d factor_ = Matrix6d::Identity();
  Matrix6d inverse_factor_ = Matrix6d::Identity();
};

/** \brief Sums for a regression of gradients on positions. They run over antithetic
 * pairs mean +- L z, in units of the Gaussian from which the pairs were drawn. Sums of
 * several chains can be added. */
struct RegressionSums {
  int num_pairs = 0;
  Vector6d mean_gradient = Vector6d::Zero();
  Matrix6d gradient_position = Matrix6d::Zero();
  Matrix6d position_position = Matrix6d::Zero();
  Matrix6d gradient_gradient = Matrix6d::Zero();
  /** Sums of L^T C L, where C is the covariance of a term, and of its part in the
   * gradients of the pairs. */
  int num_noise_samples = 0;
  Matrix6d term_noise = Matrix6d::Zero();
  Matrix6d pair_noise = Matrix6d::Zero();

  RegressionSums&
  operator+=(const RegressionSums& other);
};

/** \brief State of the fit of a Gaussian to the density. */
struct GaussianFit {
  Gaussian gaussian;
  /** Covariance C of the gradient of a term, averaged over the Gaussian. */
  Matrix6d term_covariance = Matrix6d::Zero();
  /** Covariance of the residuals of the regression beyond that noise: the density is
   * not Gaussian. */
  Matrix6d nonlinearity = Matrix6d::Zero();
  double temperature = 1.0;
  /** Whether the last update was small. */
  bool has_converged = false;
};

/** \brief Evaluate the gradients of \p num_pairs pairs at the temperature of the fit,
 * in batches large enough to learn from. */
RegressionSums
collectGradients(StochasticEnergy& energy,
                 const GaussianFit& fit,
                 int num_pairs,
                 Random& random);

/** \brief Do one step of the regression: new mean, precision and noise.
 * \param[in] sums from collectGradients() at \p fit
 * \param[in] gain in (0, 1], share of the new slope in the precision
 * \param[in] prior_precision half of it bounds the precision from below
 * \param[in,out] fit to improve */
void
updateFit(const RegressionSums& sums,
          double gain,
          const Matrix6d& prior_precision,
          GaussianFit& fit);

/** \brief Fit a Gaussian at \p start. The temperature falls to 1 from a value that
 * smooths the roughness of the likelihood. Use one call for each chain.
 * \param[in] energy -log density and its stochastic gradients
 * \param[in] start near a mode
 * \param[in] random generator of the chain
 * \param[in] keep_going called after each iteration; returning false ends the fit */
GaussianFit
fitTempered(StochasticEnergy& energy,
            const Vector6d& start,
            Random& random,
            const std::function<bool()>& keep_going);

} // namespace bayesian_icp
