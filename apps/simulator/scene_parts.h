/** \file
 * \brief How the scenes are put together: solids, and the lists of scenes. Internal to
 * scenes.cpp and its helpers.
 *
 * Functions give signed distances [m]: negative inside, zero on the surface. Outside a
 * solid each value is the distance or a lower bound of it, so a ray may always advance
 * by it. min() of two is their union, max(a, -b) is a without b.
 */
#pragma once

#include "simulator/scenes.h"

#include <string>
#include <vector>

namespace bayesian_icp::simulator {

/** \brief sqrt of the sum of squares: rounded alike everywhere, unlike std::hypot. */
double
length(double x, double y);

/** \brief Box between two opposite corners. */
double
boxDistance(const Eigen::Vector3d& point,
            const Eigen::Vector3d& lower_corner,
            const Eigen::Vector3d& upper_corner);

/** \brief Cylinder standing on the plane z = 0, its axis the z axis. */
double
cylinderDistance(const Eigen::Vector3d& point, double radius, double height);

/** \brief The solid with its origin moved to \p origin. */
DistanceFunction
movedTo(const Eigen::Vector3d& origin, DistanceFunction distance);

/** \brief A solid whose foot is at \p origin: \p size says how long, wide and high it
 * is, and \p distance gives its distances in the frame of its foot. Rays skip it by its
 * size. */
ScenePart
standing(const std::string& name,
         const Eigen::Vector3d& origin,
         const Eigen::Vector3d& size,
         DistanceFunction distance);

/** \brief A box between two opposite corners. */
ScenePart
box(const std::string& name,
    const Eigen::Vector3d& lower_corner,
    const Eigen::Vector3d& upper_corner);

/** \brief An upright cylinder whose foot is at \p origin. */
ScenePart
cylinder(const std::string& name,
         const Eigen::Vector3d& origin,
         double radius,
         double height);

/** \brief The floor z = 0. */
ScenePart
floorPart(const std::string& name = "floor");

/** \brief Things of the size of a hand or a table. */
std::vector<Scene>
objectScenes();

/** \brief Indoor places to walk or drive through, and plain ground. */
std::vector<Scene>
placeScenes();

/** \brief Things that stand on the ground out of doors, and scenes to drive through,
 * along the x axis. */
std::vector<Scene>
outdoorScenes();

} // namespace bayesian_icp::simulator
