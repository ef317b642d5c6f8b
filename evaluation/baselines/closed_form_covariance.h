/** \file
 * \brief Closed-form covariance of ICP: Censi, *An accurate closed-form estimate of
 * ICP's covariance* (ICRA 2007), in three dimensions, for point-to-point and
 * point-to-plane residuals as Prakhya et al. (*A closed-form estimate of 3D ICP
 * covariance*, MVA 2015).
 *
 * The minimiser x of J(x, z), z the coordinates of all source and target points,
 * has cov(x) = (d2J/dx2)^-1 (d2J/dzdx) cov(z) (d2J/dzdx)^T (d2J/dx2)^-1 to first order
 * in the noise. Correspondences and normals are taken as given: that the noise and the
 * pose change them is what this covariance does not see.
 *
 * J is half the sum of squared residuals, cov(z) = sigma^2 I, and x is a left twist
 * (v, w) about a centre, target frame [m, rad], as in geometry/twist.h; about the
 * origin it is CovarianceConvention::LeftSE3. Derivatives are exact, with the second
 * derivatives of the rotation.
 */
#pragma once

#include "baselines/hessian_covariance.h"

namespace bayesian_icp {

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
