/** \file
 * \brief A mixture of multivariate t distributions: the proposal with which Metropolis
 * steps cross a bent or many-moded density.
 */
#pragma once

#include <bayesian_icp/export.h>
#include <bayesian_icp/pose.h>
#include <bayesian_icp/random.h>

#include <Eigen/Cholesky>

#include <vector>

namespace bayesian_icp {

/** \brief Components from expectation maximisation of Gaussians, sampled with heavier
 * (multivariate t) tails, so that the mixture covers the tails of what it was fitted
 * to. */
class BAYESIAN_ICP_EXPORT TMixture {
public:
  /** \brief No component yet: add() one before use. */
  TMixture() = default;

  /** \param[in] draws many rows, finite and not in a plane; components get at least 60
   *            of them, so that there may be fewer
   * \param[in] num_components wanted
   * \param[in] random chooses the first centres */
  TMixture(const PoseMatrix& draws, int num_components, Random& random);

  /** \brief One more component.
   * \param[in] mean of the component
   * \param[in] covariance positive definite; of the t's Gaussian, not of the t
   * \param[in] weight in (0, 1], what it weighs in the mixture thereafter; not used for
   *            the first component */
  void
  add(const Vector6d& mean, const Matrix6d& covariance, double weight);

  Vector6d
  draw(Random& random) const;

  /** \brief Normalised. */
  double
  logDensity(const Vector6d& x) const;

  /** \brief Mean of the components' covariances, by weight: how far the density reaches
   * where it is nearly Gaussian. */
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

  /** Rows: share of each component in each draw. */
  Eigen::MatrixXd
  responsibilities(const PoseMatrix& draws) const;

  void
  maximise(const PoseMatrix& draws, const Eigen::MatrixXd& shares);

  std::vector<Component> components_;
};

} // namespace bayesian_icp
