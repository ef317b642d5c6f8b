/** \file
 * \brief Interface of a six-dimensional density for the preconditioned sampler. It
 * knows nothing about poses or point clouds.
 */
#pragma once

#include <bayesian_icp/pose.h>
#include <bayesian_icp/random.h>

#include <cstddef>

namespace bayesian_icp {

/** \brief Gradient of the energy -log density, in two parts. */
struct SplitGradient {
  /** Gradient of the likelihood, estimated from a batch of its terms. */
  Vector6d likelihood;
  /** Gradient of the prior, exact. */
  Vector6d prior;
};

/** \brief Interface of a density for Langevin steps: noisy gradients of -log density.
 * The part of the likelihood comes from a batch of its terms. Each chain has its own
 * object. */
class StochasticGradient {
public:
  virtual ~StochasticGradient() = default;

  /** \brief Gradient from \p batch_size terms, drawn without replacement; at most all
   * terms. */
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

/** \brief Energy U(x) = likelihood + prior. The likelihood is a mean of n terms, and a
 * batch of them may be used. Each chain has its own object: it may keep buffers and
 * remember what makes it faster, but its results must depend on the arguments alone. */
class StochasticEnergy : public StochasticGradient {
public:
  /** \brief n, at least 1. A batch of n terms has no noise. */
  virtual std::size_t
  numTerms() const = 0;

  /** \brief Covariance C of the gradient of a single term: the likelihood gradient of m
   * terms has the covariance C (1/m - 1/n). May be an estimate. */
  virtual Matrix6d
  termCovariance(const Vector6d& x, Random& random) = 0;

  /** \brief Rough Hessian of the likelihood, positive semidefinite. The warm-up starts
   * from it. */
  virtual Matrix6d
  roughCurvature(const Vector6d& x) = 0;

  /** \brief Hessian of the prior, positive semidefinite. */
  virtual Matrix6d
  priorPrecision() const = 0;

  /** \brief U(x) up to a constant. It always uses the same terms, so that values can be
   * compared. */
  virtual double
  energy(const Vector6d& x) = 0;

  /** \brief U(x) up to a constant, from all terms. Metropolis steps sample it. */
  virtual double
  fullEnergy(const Vector6d& x) = 0;

  /** \brief The pose that \p x stands for [m, rad]. */
  virtual Vector6d
  toPose(const Vector6d& x) const = 0;

  /** \brief A starting point, over-dispersed with respect to the density. */
  virtual Vector6d
  drawStart(Random& random) = 0;

  /** \brief Move from \p start to a point near a mode. */
  virtual Vector6d
  burnIn(const Vector6d& start, Random& random) = 0;

  /** \brief Temperature at which the warm-up starts: a Gaussian at that temperature is
   * wide enough to smooth the roughness of the likelihood.
   * \param[in] x near a mode
   * \param[in] covariance of the Gaussian at temperature 1 */
  virtual double
  initialTemperature(const Vector6d& x, const Matrix6d& covariance) = 0;
};

} // namespace bayesian_icp
