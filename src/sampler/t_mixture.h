/** \file
 * \brief A mixture of multivariate t distributions. Metropolis steps use it as the
 * proposal that crosses a bent or multi-modal density.
 */
#pragma once

#include "algebra/decompositions.h"

#include <bayesian_icp/pose.h>
#include <bayesian_icp/random.h>

#include <vector>

namespace bayesian_icp {

/** \brief Sample covariance of at least two draws, one in each row. */
Matrix6d
covarianceOf(const PoseMatrix& draws);

/** \brief Components are fitted as Gaussians by expectation maximisation, and sampled
 * as multivariate t distributions. These have heavier tails, so the mixture covers the
 * tails of the fitted draws. */
class TMixture {
public:
  /** \brief An empty mixture: call add() before use. */
  TMixture() = default;

  /** \param[in] draws many rows, finite and not in a plane
   * \param[in] num_components largest number of components; each needs at least 60
   *            draws, so there may be fewer
   * \param[in] random chooses the first centres */
  TMixture(const PoseMatrix& draws, int num_components, Random& random);

  /** \brief Add a component.
   * \param[in] mean of the component
   * \param[in] covariance positive definite; that of the Gaussian of the t
   *            distribution, not of the t distribution itself
   * \param[in] weight in (0, 1], weight of this component in the new mixture; not used
   *            for the first component */
  void
  add(const Vector6d& mean, const Matrix6d& covariance, double weight);

  Vector6d
  draw(Random& random) const;

  /** \brief Normalised log density. */
  double
  logDensity(const Vector6d& x) const;

  /** \brief Weighted mean of the components' covariances. It says how far the density
   * reaches where it is nearly Gaussian. */
  Matrix6d
  covarianceWithin() const;

private:
  struct Component {
    double log_weight;
    Vector6d mean;
    Eigen::LLT<Matrix6d> covariance;
    double log_determinant;
  };

  static Component
  makeComponent(const Vector6d& mean, const Matrix6d& covariance, double log_weight);

  /** Squared Mahalanobis distance. */
  static double
  squaredDistance(const Component& component, const Vector6d& x);

  /** Share of each component in each draw; each row is one draw. */
  Eigen::MatrixXd
  responsibilities(const PoseMatrix& draws) const;

  void
  maximise(const PoseMatrix& draws, const Eigen::MatrixXd& shares);

  std::vector<Component> components_;
};

} // namespace bayesian_icp
