/** \file
 * \brief Principal axes of a covariance of twists in a metric.
 */
#pragma once

#include "algebra/decompositions.h"

#include <bayesian_icp/pose.h>

#include <cmath>

namespace bayesian_icp {

/** \brief Axes along which twists are uncorrelated, tightest first. */
struct PrincipalAxes {
  /** Columns are of unit length in the metric. Their signs, which decide what random
   * numbers do, do not depend on rounding. */
  Matrix6d axes;
  Vector6d variances;

  PrincipalAxes(const Matrix6d& covariance, const Matrix6d& metric)
  {
    const Matrix6d L = metric.llt().matrixL();
    const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(
        Matrix6d(L.transpose() * covariance * L));
    Matrix6d directions = solver.eigenvectors();
    for (auto direction : directions.colwise()) {
      Eigen::Index largest = 0;
      direction.cwiseAbs().maxCoeff(&largest);
      if (direction[largest] < 0.0)
        direction = -direction;
    }
    axes = L.transpose().triangularView<Eigen::Upper>().solve(directions);
    variances = solver.eigenvalues();
  }
};

/** \brief Root mean square distance of the source's points from their centroid [m].
 * \param[in] displacement_metric as displacementMetric() gives it */
inline double
radiusOf(const Matrix6d& displacement_metric)
{
  return std::sqrt(0.5 * displacement_metric.bottomRightCorner<3, 3>().trace());
}

} // namespace bayesian_icp
