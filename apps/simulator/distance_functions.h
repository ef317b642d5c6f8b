/** \file
 * \brief Signed distances [m] to simple solids: negative inside, zero on the surface.
 *
 * Outside a solid each value is the distance or a lower bound of it, so a ray may
 * always advance by it. min() of two is their union, max(a, -b) is a without b.
 */
#pragma once

#include <Eigen/Core>

namespace bayesian_icp::simulator {

/** \brief Box centred at the origin, sides along the axes. */
double
boxDistance(const Eigen::Vector3d& point, const Eigen::Vector3d& half_size);

/** \brief Box between two opposite corners. */
double
boxDistance(const Eigen::Vector3d& point,
            const Eigen::Vector3d& lower_corner,
            const Eigen::Vector3d& upper_corner);

/** \brief Cylinder standing on the plane z = 0, its axis the z axis. */
double
cylinderDistance(const Eigen::Vector3d& point, double radius, double height);

/** \brief Torus centred at the origin, its ring in the x-z plane. */
double
torusDistance(const Eigen::Vector3d& point, double ring_radius, double tube_radius);

/** \brief Spherical shell with a round rim: the part below the plane z = \p rim_height
 * of a sphere about the origin, thickened by \p half_thickness to both sides. */
double
sphericalBowlDistance(const Eigen::Vector3d& point,
                      double sphere_radius,
                      double rim_height,
                      double half_thickness);

} // namespace bayesian_icp::simulator
