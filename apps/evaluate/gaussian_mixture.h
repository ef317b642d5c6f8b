/** \file
 * \brief A mixture of multivariate t distributions fitted to draws: the proposal with
 * which a long Metropolis run crosses a bent or many-moded density.
 */
#pragma once

#include <bayesian_icp/pose.h>
#include <bayesian_icp/random.h>

#include <Eigen/Cholesky>

#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Gaussian components from expectation maximisation, sampled with heavier
 * (multivariate t) tails, so that the proposal covers the density's own. */
class Mixture {
public:
  /** \param[in] draws many rows, not in a plane; components get at least 60 of them, so
   * that there may be fewer
   * \param[in] random chooses the first centres */
  Mixture(const PoseMatrix& draws, int num_components, Random& random);

  Vector6d
  draw(Random& random) const;

  /** \brief log density, up to a constant. */
  double
  logDensity(const Vector6d& x) const;

private:
  struct Component {
    double log_weight;
    Vector6d mean;
    Eigen::LLT<Matrix6d> covariance;
    double log_determinant;
  };

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

} // namespace bayesian_icp::evaluate
