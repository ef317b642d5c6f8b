/** \file
 * \brief Small motions as twists about a point: the coordinates of preset `calibrated`.
 *
 * A twist xi = (v, w) [m, rad] moves a pose from the left, T' = exp(xi) T, in the
 * target frame and about a centre o: a point p goes to o + exp(w)(p - o) + V(w) v. With
 * o at the moved source's centroid, rotations and translations are nearly independent
 * and the motions along which surfaces slide (about an axis, along an edge) are
 * straight lines.
 */
#pragma once

#include <bayesian_icp/prior.h>

#include <Eigen/Geometry>

#include <optional>

namespace bayesian_icp {

/** \brief exp(xi) T about \p centre. */
Eigen::Isometry3d
movedBy(const Vector6d& xi,
        const Eigen::Vector3d& centre,
        const Eigen::Isometry3d& T_target_source);

/** \brief The twist xi about \p centre with to = exp(xi) from. */
Vector6d
twistBetween(const Eigen::Isometry3d& from,
             const Eigen::Isometry3d& to,
             const Eigen::Vector3d& centre);

/** \brief The isometry T_target_source of a pose (x, y, z, roll, pitch, yaw). */
Eigen::Isometry3d
isometryOf(const Vector6d& pose);

/** \brief A plane of the source that stays in one of the target. */
struct PlaneHold {
  /** A point of each plane and its unit normal, in the frame of its cloud [m]. */
  Eigen::Vector3d source_point, source_normal, target_point, target_normal;
  /** Standard deviation of the source's point from the target's plane [m], and of the
   * angle between the planes [rad]. */
  double distance_sd, angle_sd;
};

/** \brief A prior, and the plane in which it holds the source, if any. */
struct HeldPrior : Prior {
  HeldPrior(const Prior& prior) : Prior(prior) {}

  /** \brief The same hold with another mean and variance. */
  HeldPrior
  with(const Vector6d& mean, const Vector6d& variance) const
  {
    HeldPrior other(Prior(mean, variance, referencePoint()));
    other.plane = plane;
    return other;
  }

  std::optional<PlaneHold> plane;
};

/** \brief d(roll, pitch, yaw) / dw for a small rotation w about the target's fixed
 * axes. At gimbal lock it is that of a pitch a little off. */
Eigen::Matrix3d
angleRates(const Vector6d& pose);

/** \brief The prior near a pose, in twists about a centre. */
struct TwistPrior {
  /** Positive semidefinite [1/m^2, 1/rad^2]. */
  Matrix6d precision = Matrix6d::Zero();
  /** Of the energy -log prior, exact at the pose. */
  Vector6d gradient = Vector6d::Zero();
  /** Twist from the prior's mean to the pose, to first order in the angles. */
  Vector6d deviation = Vector6d::Zero();
};

/** \brief \p prior at \p T_target_source: the precision is the Hessian at the prior's
 * mean, carried over by the derivative of (Prior::deviation) with respect to xi. */
TwistPrior
twistPrior(const HeldPrior& prior,
           const Eigen::Isometry3d& T_target_source,
           const Eigen::Vector3d& centre);

/** \brief -log \p prior at \p T_target_source, as a density of motions. Of the two
 * triples of angles of the rotation it takes the one that the prior prefers, so it is
 * smooth where a free pitch passes 90 degrees. */
double
twistPriorEnergy(const HeldPrior& prior, const Eigen::Isometry3d& T_target_source);

/** \brief The gradient of twistPriorEnergy(), and of twistPrior(), alone. */
Vector6d
twistPriorGradient(const HeldPrior& prior,
                   const Eigen::Isometry3d& T_target_source,
                   const Eigen::Vector3d& centre);

} // namespace bayesian_icp
