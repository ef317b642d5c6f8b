/** \file
 * \brief A density in six dimensions as the preconditioned sampler sees it. Knows
 * nothing of point clouds.
 */
#pragma once

#include <bayesian_icp/export.h>
#include <bayesian_icp/pose.h>
#include <bayesian_icp/random.h>

#include <cstddef>

namespace bayesian_icp {

/** \brief Gradient of the energy -log density, in its two parts. */
struct SplitGradient {
  /** Of the likelihood, estimated from a batch of its terms. */
  Vector6d likelihood;
  /** Of the prior, exact. */
  Vector6d prior;
};

/** \brief What Langevin steps need of a density: noisy gradients of -log density, the
 * likelihood's part from a batch of its terms. One object belongs to one chain. */
class BAYESIAN_ICP_EXPORT StochasticGradient {
public:
  virtual ~StochasticGradient() = default;

  /** \brief Gradient from \p batch_size terms, at most all, drawn without replacement.
   */
  virtual SplitGradient
  gradient(const Vector6d& x, std::size_t batch_size, Random& random) = 0;

  /** \brief Whether \p x is so far out that the chain has to be stopped; by default, if
   * it is not finite. */
  virtual bool
  hasDiverged(const Vector6d& x) const
  {
    return !x.allFinite();
  }
};

/** \brief Energy U(x) = likelihood + prior, the likelihood a mean of n terms of which a
 * batch may be looked at. One object belongs to one chain: it may keep buffers and
 * remember what speeds it up, but its answers must depend on the arguments alone. */
class BAYESIAN_ICP_EXPORT StochasticEnergy : public StochasticGradient {
public:
  /** \brief n, at least 1. A batch of n terms has no noise. */
  virtual std::size_t
  numTerms() const = 0;

  /** \brief Covariance C of the gradient of a single term, such that the likelihood
   * gradient of m terms has the covariance C (1/m - 1/n). May be an estimate. */
  virtual Matrix6d
  termCovariance(const Vector6d& x, Random& random) = 0;

  /** \brief Rough Hessian of the likelihood, positive semidefinite: where the warm-up
   * starts from. */
  virtual Matrix6d
  roughCurvature(const Vector6d& x) = 0;

  /** \brief Hessian of the prior, positive semidefinite. */
  virtual Matrix6d
  priorPrecision() const = 0;

  /** \brief U(x) up to a constant, always from the same terms, so that values can be
   * compared. */
  virtual double
  energy(const Vector6d& x) = 0;

  /** \brief U(x) up to a constant from all terms: what Metropolis steps sample. */
  virtual double
  fullEnergy(const Vector6d& x) = 0;

  /** \brief The pose that \p x stands for [m, rad]. */
  virtual Vector6d
  toPose(const Vector6d& x) const = 0;

  /** \brief A starting point, over-dispersed with respect to the density. */
  virtual Vector6d
  drawStart(Random& random) = 0;

  /** \brief A point near a mode, reached from \p start. */
  virtual Vector6d
  burnIn(const Vector6d& start, Random& random) = 0;

  /** \brief Temperature from which the warm-up cools down: one at which a Gaussian is
   * wide enough to look over the roughness of the likelihood.
   * \param[in] x near a mode
   * \param[in] covariance of the Gaussian at temperature 1 */
  virtual double
  initialTemperature(const Vector6d& x, const Matrix6d& covariance) = 0;
};

} // namespace bayesian_icp
