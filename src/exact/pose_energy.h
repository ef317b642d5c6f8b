/** \file
 * \brief The energy that preset `exact` samples: -log posterior of the pose.
 */
#pragma once

#include "search/target.h"

#include <bayesian_icp/prior.h>

namespace bayesian_icp {

/** \brief rho(r) [m^2] of a squared residual r^2 [m^2]. */
double
robustEnergy(const ResidualOptions& options, double squared_residual);

/** \brief rho'(r) / r, dimensionless: 1 without a kernel. */
double
robustWeight(const ResidualOptions& options, double squared_residual);

/** \brief Buffers of one thread, with what it knows of the points' neighbours. */
struct EnergyWorkspace {
  NeighborCache neighbors;
  Eigen::Matrix3Xf arms;
  Eigen::Matrix3Xf moved;
  std::vector<TargetMatch> matches;
};

/** \brief Likelihood of a batch of source points: means over the batch, before the
 * weight. Derivatives are with respect to the centred pose of PoseEnergy. */
struct BatchTerms {
  /** \brief What is computed besides the energy; the last two include the gradient. */
  enum Extras { Nothing, Gradient, SecondMoment, Curvature };

  /** Mean of rho(r_i) [m^2]. */
  double energy = 0.0;
  /** Mean of squared match distances [m^2]; unmatched points are left out. */
  double squared_distance = 0.0;
  Vector6d gradient = Vector6d::Zero();
  /** Extras SecondMoment: mean outer product of the points' gradients. */
  Matrix6d second_moment = Matrix6d::Zero();
  /** Extras Curvature: Gauss-Newton matrices of point-to-point residuals, and of
   * point-to-plane residuals or of DistributionToDistribution's. */
  Matrix6d point_curvature = Matrix6d::Zero();
  Matrix6d plane_curvature = Matrix6d::Zero();
};

/** \brief U = weight * mean_i rho(r_i) - log prior, with rho and gate of
 * ResidualOptions.
 *
 * Functions of the pose take theta = (x, y, z, roll, pitch, yaw) [m, rad]. The sampler
 * works in the centred pose phi = (t', roll, pitch, yaw) with p = R (s - c) + c + t',
 * where c is the centroid of the source. Rotations and translations are then nearly
 * independent. The map between theta and phi has determinant 1, so both have the same
 * energy.
 *
 * All functions are const. Several threads may call them if target().isThreadSafe(). */
class PoseEnergy {
public:
  /** \param[in] source_points 3 x n, finite, source frame [m]
   * \param[in] target must outlive this object; needs normals for
   *            Residual::PointToPlane and covariances for DistributionToDistribution
   * \param[in] prior of theta
   * \param[in] weight N / sigma^2 [1/m^2]
   * \param[in] residual residual, kernel and gate */
  PoseEnergy(const Eigen::Matrix3Xd& source_points,
             const Target& target,
             const Prior& prior,
             double weight,
             const ResidualOptions& residual);

  /** \brief U(theta), over all source points. */
  double
  energy(const Vector6d& theta) const;

  /** \brief The same value. From the second call with one workspace on it is faster,
   * because the search starts at the neighbours of the last call. */
  double
  energy(const Vector6d& theta, EnergyWorkspace& workspace) const;

  Vector6d
  toTheta(const Vector6d& phi) const;

  Vector6d
  toPhi(const Vector6d& theta) const;

  /** \brief Likelihood terms of a batch at the centred pose \p phi. Derivatives are at
   * fixed correspondences.
   * \param[in] phi centred pose [m, rad]
   * \param[in] indices source points of the batch, at least one
   * \param[in] extras what to compute besides the energy
   * \param[in] residual replaces residual(): burn-in starts without a kernel
   * \param[in,out] workspace of this thread */
  BatchTerms
  batchTerms(const Vector6d& phi,
             const std::vector<std::size_t>& indices,
             BatchTerms::Extras extras,
             const ResidualOptions& residual,
             EnergyWorkspace& workspace) const;

  /** \brief -log prior at the centred pose. */
  double
  priorEnergy(const Vector6d& phi) const;

  /** \brief Gradient of priorEnergy() with respect to the centred pose. */
  Vector6d
  priorGradient(const Vector6d& phi) const;

  /** \brief Hessian of priorEnergy() at the prior's mean, with respect to the centred
   * pose. */
  Matrix6d
  priorPrecision() const;

  /** \brief An empty workspace, without neighbours. */
  EnergyWorkspace
  makeWorkspace() const;

  /** \brief 0, 1, ..., numPoints() - 1. */
  std::vector<std::size_t>
  allPoints() const;

  std::size_t
  numPoints() const
  {
    return static_cast<std::size_t>(arms_.cols());
  }

  double
  weight() const
  {
    return weight_;
  }

  const ResidualOptions&
  residual() const
  {
    return residual_;
  }

  const Target&
  target() const
  {
    return target_;
  }

  const Prior&
  prior() const
  {
    return prior_;
  }

private:
  void
  moveBatch(const Vector6d& phi,
            const std::vector<std::size_t>& indices,
            EnergyWorkspace& workspace) const;

  const Target& target_;
  Prior prior_;
  double weight_;
  ResidualOptions residual_;
  Eigen::Vector3d centroid_;
  Eigen::Matrix3Xf arms_;
  Eigen::Matrix3Xf normals_;
  /** Of Residual::DistributionToDistribution, source frame; else empty. */
  std::vector<Eigen::Matrix3d> covariances_;
};

} // namespace bayesian_icp
