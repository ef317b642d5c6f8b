/** \file
 * \brief Errors of poses that are alike along, and about, all axes.
 */
#pragma once

#include "geometry/twist.h"

#include <bayesian_icp/random.h>

#include <Eigen/Geometry>

namespace bayesian_icp::evaluate {

/** \brief Standard deviations of each axis [m, rad]. */
struct AxisDeviation {
  double translation = 0.0;
  double rotation = 0.0;

  /** \brief Of all six coordinates, of a pose or of a twist. */
  Vector6d
  vector() const
  {
    Vector6d sd;
    sd << Eigen::Vector3d::Constant(translation), Eigen::Vector3d::Constant(rotation);
    return sd;
  }
};

/** \brief A pose with random errors as an odometry has them: a shift, and a turn about
 * the pose's own origin. */
inline Eigen::Isometry3d
perturbed(Eigen::Isometry3d pose, const AxisDeviation& sd, Random& random)
{
  const Vector6d error = sd.vector().cwiseProduct(random.normal6());
  pose.linear() = expSO3(error.tail<3>()) * pose.linear();
  pose.translation() += error.head<3>();
  return pose;
}

} // namespace bayesian_icp::evaluate
