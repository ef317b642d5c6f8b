/** \file
 * \brief Coordinates of poses near a mode, and the calibrated density in them. Motions
 * that only the prior holds are separate coordinates.
 */
#pragma once

#include "calibrated/calibrated_estimate.h"
#include "sampler/gaussian_fit.h"

namespace bayesian_icp {

/** \brief Coordinates z = (a, b) with pose(z) = exp(V0 a) exp(VK b) mode, V0 the
 * directions that the prior alone holds (keep = 0), VK the others.
 *
 * The likelihood depends on b only. It stays the same however far a wide prior lets a
 * go, for instance about an axis of symmetry or along an edge. Whole turns of V0 a are
 * dropped, because the prior's angles are periodic, and a turn of a screw would shift
 * b. To second order in b, the energy of the likelihood is 1/2 (b - b^)^T Lambda_b (b -
 * b^). The prior is exact everywhere. */
class ProductCoordinates {
public:
  explicit ProductCoordinates(const CalibratedEstimate& estimate);

  /** \brief Number of directions that the prior alone holds: the length of a. */
  int
  numPriorOnly() const
  {
    return num_prior_only_;
  }

  Eigen::Isometry3d
  pose(const Vector6d& z) const;

  /** \brief The part (0, b) of \p pose: what remains after the prior-only motion that
   * brings it nearest to the mode. */
  Vector6d
  heldPart(const Eigen::Isometry3d& pose) const;

  /** \brief The twist T VK b from the mode, at which scores are evaluated for z. */
  Vector6d
  scoredTwist(const Vector6d& z) const
  {
    return transfer_ * (held_ * z);
  }

  /** \brief The mode moved by scoredTwist(). */
  Eigen::Isometry3d
  scoredPose(const Vector6d& z) const
  {
    return movedBy(scoredTwist(z), centre_, mode_);
  }

  /** \brief VK^T T^T H J^-1. It maps total scores to gradients of the likelihood's
   * energy with respect to z, and weights them such that the draws have the right
   * spread. */
  const Matrix6d&
  scoreWeights() const
  {
    return score_weights_;
  }

  /** \brief Lambda_b (z - (0, b^)): gradient of the likelihood's energy if it were
   * Gaussian. */
  Vector6d
  linearGradient(const Vector6d& z) const
  {
    return information_ * (z - best_fit_);
  }

  /** \brief Energy of the likelihood if it were Gaussian. */
  double
  linearEnergy(const Vector6d& z) const
  {
    return 0.5 * (z - best_fit_).dot(linearGradient(z));
  }

  /** \brief z without whole turns of V0 a: the same pose. */
  Vector6d
  unwound(const Vector6d& z) const;

  /** \brief Gradient of -log prior at pose(z) with respect to z, exact. */
  Vector6d
  priorGradient(const Vector6d& z, const HeldPrior& prior) const;

  /** \brief Gradient of log |det d(motion) / d(a)| at b = 0, motions as small twists:
   * the same change of a is a smaller motion where V0 a is a large rotation. To first
   * order in a. */
  Vector6d
  volumeGradient(const Vector6d& z) const
  {
    return volume_slope_ + volume_curvature_ * unwound(z);
  }

  /** \brief log |det [V0 VK]|, which converts densities of z into those of twists. */
  double
  logVolume() const;

  /** \brief The posterior if likelihood and prior were Gaussian. */
  const Gaussian&
  gaussian() const
  {
    return gaussian_;
  }

private:
  void
  setUnwinding(const Matrix6d& prior_precision);

  void
  setVolume();

  void
  setLikelihood(const CalibratedEstimate& estimate);

  Eigen::Isometry3d mode_;
  Eigen::Vector3d centre_;
  Matrix6d transfer_;
  /** Twists from the mode of (a, 0) and (0, b). */
  Matrix6d prior_only_, held_;
  int num_prior_only_ = 0;
  /** Maps a rotation vector to (a, 0) such that V0 a has this rotation and is most
   * probable under the prior. */
  Eigen::Matrix<double, 6, 3> unwinding_ = Eigen::Matrix<double, 6, 3>::Zero();
  /** volumeGradient() at 0, and its derivatives. */
  Vector6d volume_slope_ = Vector6d::Zero();
  Matrix6d volume_curvature_ = Matrix6d::Zero();
  Matrix6d score_weights_ = Matrix6d::Zero();
  /** Lambda_b, and zeros in the rows and columns of a. */
  Matrix6d information_ = Matrix6d::Zero();
  /** (0, b^). */
  Vector6d best_fit_ = Vector6d::Zero();
  Gaussian gaussian_;
};

} // namespace bayesian_icp
