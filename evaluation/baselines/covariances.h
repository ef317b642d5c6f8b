/** \file
 * \brief Covariances of ICP from its pairs of points: from the Hessian, and in closed
 * form.
 *
 * Coordinates are left twists (v, w) about a centre, target frame [m, rad], as in
 * geometry/twist.h; about the origin they are CovarianceConvention::LeftSE3.
 *
 * Users of ICP and GICP build a covariance from the Hessian: every point an independent
 * measurement of the same noise.
 *
 * The closed form is that of Censi, *An accurate closed-form estimate of ICP's
 * covariance* (ICRA 2007), in three dimensions, for point-to-point and point-to-plane
 * residuals as Prakhya et al. (*A closed-form estimate of 3D ICP covariance*, MVA
 * 2015). The minimiser x of J(x, z), z the coordinates of all source and target points,
 * has cov(x) = (d2J/dx2)^-1 (d2J/dzdx) cov(z) (d2J/dzdx)^T (d2J/dx2)^-1 to first order
 * in the noise. Correspondences and normals are taken as given: that the noise and the
 * pose change them is what this covariance does not see. J is half the sum of squared
 * residuals, cov(z) = sigma^2 I. Derivatives are exact, with the second derivatives of
 * the rotation.
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
  /** The target point of each pair: in the closed form one that is in several pairs is
   * one measurement. */
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

/** \brief Second derivatives of J at one pose. */
struct ClosedFormDerivatives {
  /** dJ/dx; zero at the minimum. */
  Vector6d gradient = Vector6d::Zero();
  /** d2J/dx2. */
  Matrix6d hessian = Matrix6d::Zero();
  /** (d2J/dzdx) (d2J/dzdx)^T: covariance of the gradient for unit noise. */
  Matrix6d gradient_covariance = Matrix6d::Zero();
};

/** \brief Evaluate the derivatives, with memory linear in the number of pairs. */
ClosedFormDerivatives
closedFormDerivatives(const MatchedPoints& matches, const Eigen::Vector3d& centre);

/** \brief The covariance at the minimum.
 * \param[in] derivatives at the minimum
 * \param[in] sigma noise of every coordinate of every point [m]
 * \return not finite where the Hessian is singular */
Matrix6d
closedFormCovariance(const ClosedFormDerivatives& derivatives, double sigma);

/** \brief What the data say about the pose: energy gradient^T x + x^T information x
 * / 2.
 */
struct GaussianInformation {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

/** \brief The covariance's inverse, H (sigma^2 M)^+ H, to be combined with a prior:
 * also where there are motions that change no residual, which get none. The gradient is
 * zero at the minimum, and elsewhere the one whose minimum is a Newton step away. */
GaussianInformation
closedFormInformation(const ClosedFormDerivatives& derivatives, double sigma);

} // namespace bayesian_icp
