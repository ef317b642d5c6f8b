/** \file
 * \brief Household objects as signed distances [m]. Each stands on the plane z = 0 of
 * its own frame with the z axis as its axis.
 */
#pragma once

#include <Eigen/Core>

namespace bayesian_icp::simulator {

/** \brief Heights of the objects [m]. */
constexpr double bowl_height = 0.076;
constexpr double can_height = 0.12;
constexpr double mug_height = 0.10;

/** \brief Bowl, 170 mm wide, with a round rim and a foot. */
double
bowlDistance(const Eigen::Vector3d& point);

/** \brief Soda can, radius 33 mm, with a recessed lid. */
double
canDistance(const Eigen::Vector3d& point);

/** \brief Cup of the mug: radius 40 mm, wall and bottom 4 mm. */
double
mugBodyDistance(const Eigen::Vector3d& point);

/** \brief Handle of the mug, on the side of the positive x axis. */
double
mugHandleDistance(const Eigen::Vector3d& point);

} // namespace bayesian_icp::simulator
