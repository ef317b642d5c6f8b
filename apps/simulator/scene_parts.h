/** \file
 * \brief How the scenes are put together: pieces used by several of them, and the lists
 * of scenes. Internal to scenes.cpp and its helpers.
 */
#pragma once

#include "simulator/distance_functions.h"
#include "simulator/scenes.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace bayesian_icp::simulator {

/** \brief The solid with its origin moved to \p origin. */
inline DistanceFunction
movedTo(const Eigen::Vector3d& origin, DistanceFunction distance)
{
  return [origin, distance = std::move(distance)](const Eigen::Vector3d& point) {
    return distance(point - origin);
  };
}

/** \brief A solid whose foot is at \p origin: \p size says how long, wide and high it
 * is, and \p distance gives its distances in the frame of its foot. Rays skip it by its
 * size. */
inline ScenePart
standing(const std::string& name,
         const Eigen::Vector3d& origin,
         const Eigen::Vector3d& size,
         DistanceFunction distance)
{
  const Eigen::Vector3d half(0.5 * size.x(), 0.5 * size.y(), 0.0);
  const Eigen::Vector3d height(0.0, 0.0, size.z());
  return {name,
          movedTo(origin, std::move(distance)),
          {origin - half, origin + half + height}};
}

/** \brief A box between two opposite corners. */
inline ScenePart
box(const std::string& name,
    const Eigen::Vector3d& lower_corner,
    const Eigen::Vector3d& upper_corner)
{
  return {name, [lower_corner, upper_corner](const Eigen::Vector3d& point) {
            return boxDistance(point, lower_corner, upper_corner);
          }};
}

/** \brief An upright cylinder whose foot is at \p origin. */
inline ScenePart
cylinder(const std::string& name,
         const Eigen::Vector3d& origin,
         double radius,
         double height)
{
  return {name, movedTo(origin, [radius, height](const Eigen::Vector3d& point) {
            return cylinderDistance(point, radius, height);
          })};
}

/** \brief The floor z = 0. */
inline ScenePart
floorPart(const std::string& name = "floor")
{
  return {name, [](const Eigen::Vector3d& point) { return point.z(); }};
}

/** \brief Endless walls at both sides of the plane y = 0. */
inline ScenePart
wallsAlong(double half_width)
{
  return {"walls", [half_width](const Eigen::Vector3d& point) {
            return half_width - std::abs(point.y());
          }};
}

/** \brief Floor, ceiling and walls of a hall about the z axis, seen from inside. */
inline ScenePart
hall(const std::string& name, const Eigen::Vector3d& half_size)
{
  const Eigen::Vector3d centre(0.0, 0.0, half_size.z());
  return {name, [centre, half_size](const Eigen::Vector3d& point) {
            return -boxDistance(point - centre, half_size);
          }};
}

/** \brief A car on the ground, 4.4 m x 1.8 m x 1.45 m, its front towards +x. */
double
carDistance(const Eigen::Vector3d& point);

/** \brief Things of the size of a hand or a table. */
std::vector<Scene>
objectScenes();

/** \brief One object made of plane faces, with its edges in view. */
std::vector<Scene>
workshopScenes();

/** \brief Indoor places to walk or drive through, and plain ground. */
std::vector<Scene>
placeScenes();

/** \brief Things that stand on the ground out of doors. */
std::vector<Scene>
outdoorScenes();

/** \brief Scenes to drive through, along the x axis. */
std::vector<Scene>
roadScenes();

} // namespace bayesian_icp::simulator
