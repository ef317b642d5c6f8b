/** \file
 * \brief Particles of Stein variational inference: how they move, and how far they are
 * from the density. It knows positions, gradients and curvatures only. All of them are
 * in coordinates in which the density has a standard deviation of about 1.
 */
#pragma once

#include <bayesian_icp/pose.h>

#include <vector>

namespace bayesian_icp {

/** \brief One column a particle. */
using ParticleMatrix = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/** \brief Directions of Stein variational gradient descent (Liu and Wang 2016, eq. 8),
 *
 *     phi(x_i) = mean_j [-k(x_j, x_i) grad U(x_j) + grad_{x_j} k(x_j, x_i)],
 *     k(x, y) = exp(-|x - y|^2 / h),
 *
 * h = median |x - y|^2 / log(n + 1). Each is divided by mean_j k(x_j, x_i): a step of
 * size 1 is then as long as one without a kernel, and the fixed points are the same.
 * \param[in] positions at least two
 * \param[in] gradients of U = -log density */
ParticleMatrix
steinGradientSteps(const ParticleMatrix& positions, const ParticleMatrix& gradients);

/** \brief Directions H_i^-1 phi(x_i) of Stein variational Newton (Detommaso et al.
 * 2018, eq. 17, blocks of the diagonal),
 *
 *     H_i = mean_j [k(x_j, x_i)^2 H(x_j) + grad k grad k^T],
 *
 * with phi and k as above.
 * \param[in] curvatures H of each particle, positive definite */
ParticleMatrix
steinNewtonSteps(const ParticleMatrix& positions,
                 const ParticleMatrix& gradients,
                 const std::vector<Matrix6d>& curvatures);

/** \brief How far particles are from the density of their gradients. */
struct SteinDiscrepancy {
  /** Kernelised Stein discrepancy of the kernel 1 + z . z', dimensionless, where z are
   * the positions scaled to mean 0 and covariance I:
   *
   *     |mean g|^2 + |I - mean g z^T|^2 (Frobenius norm), square root of,
   *
   * g = grad_z U. It controls mean and covariance, which kernels that decay do not (H.
   * Kanagawa et al. 2022), and is not zero where the particles' own kernel is blind: at
   * the fixed points of steinGradientSteps(). It sees neither what is beyond second
   * moments nor modes without a particle. NaN if the particles span no volume. */
  double value;
  /** Mean of the diagonal of mean g z^T: the particles' variance as a share of the
   * density's, if that is a Gaussian. */
  double variance_share;
};

/** \brief Discrepancy of particles; unchanged by affine maps of the space.
 * \param[in] positions at least 7
 * \param[in] gradients of U = -log density */
SteinDiscrepancy
steinDiscrepancy(const ParticleMatrix& positions, const ParticleMatrix& gradients);

} // namespace bayesian_icp
