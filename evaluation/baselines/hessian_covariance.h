/** \file
 * \brief The covariance that users of ICP and GICP build from the Hessian: every point
 * an independent measurement of the same noise.
 *
 * Coordinates are left twists (v, w) about a centre, target frame [m, rad], as in
 * geometry/twist.h; about the origin they are CovarianceConvention::LeftSE3.
 */
#pragma once

#include <bayesian_icp/pose.h>

#include <cstdint>
#include <vector>

namespace bayesian_icp {

/** \brief Moved source points p and their target points q, one pair a column. The
 * residual of a pair is p - q, or n . (p - q) if there are normals n. */
struct MatchedPoints {
  /** p = T_target_source s, target frame [m]. */
  Eigen::Matrix3Xd moved;
  /** q, target frame [m]. */
  Eigen::Matrix3Xd target;
  /** n, unit vectors; empty: point to point. */
  Eigen::Matrix3Xd normals;
  /** The target point of each pair, so that one which is in several pairs counts as
   * one measurement; empty: all are different. */
  std::vector<std::uint32_t> target_indices;

  bool
  hasNormals() const
  {
    return normals.cols() > 0;
  }
};

/** \brief Least squares at one pose: the energy is half the sum of squares. */
struct GaussNewton {
  /** Without the second derivatives of the residuals [1, m, m^2]. */
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  /** [m^2]. */
  double sum_of_squares = 0.0;
  /** Three a pair, or one with normals. */
  Eigen::Index num_residuals = 0;
};

/** \brief Hessian and gradient of half the sum of squared residuals. */
GaussNewton
gaussNewton(const MatchedPoints& matches, const Eigen::Vector3d& centre);

/** \brief Variance of a residual's coordinate, without any discount for parameters or
 * for neighbours that err alike: the naive sigma^2 [m^2]; NaN without residuals. */
double
residualVariance(const GaussNewton& sums);

/** \brief Gauss-Newton Hessian of GICP, sum_i A_i^T C_i^-1 A_i, in units of its energy
 * (no sigma).
 * \param[in] moved 3 x n, target frame [m]
 * \param[in] covariances C_i = C_target + R C_source R^T of each pair, target frame
 * \param[in] centre of the twists, target frame [m] */
Matrix6d
generalizedIcpHessian(const Eigen::Matrix3Xd& moved,
                      const std::vector<Eigen::Matrix3d>& covariances,
                      const Eigen::Vector3d& centre);

/** \brief sigma^2 H^-1; not finite where H is singular. */
Matrix6d
hessianCovariance(const Matrix6d& hessian, double sigma);

} // namespace bayesian_icp
