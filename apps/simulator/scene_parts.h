/** \file
 * \brief How the scenes are put together: pieces used by several of them, and the
 * functions that make each scene. Internal to scenes.cpp and its helpers.
 */
#pragma once

#include "simulator/distance_functions.h"
#include "simulator/scenes.h"

#include <string>
#include <utility>

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

/** \brief The floor z = 0. */
inline ScenePart
floorPart(const std::string& name = "floor")
{
  return {name, [](const Eigen::Vector3d& point) { return point.z(); }};
}

/** \brief A car on the ground, 4.4 m x 1.8 m x 1.45 m, its front towards +x. */
double
carDistance(const Eigen::Vector3d& point);

Scene
makeBowl();

Scene
makeCan();

/** \brief Mug with its handle on the +x side, in full view from -y. */
Scene
makeMug();

/** \brief The same mug with its handle on the +y side, hidden from -y. */
Scene
makeMugHiddenHandle();

Scene
makeTableTop();

/** \brief A smaller table top, for views that show its edges. */
Scene
makeTablePlate();

Scene
makeTable();

Scene
makeBox();

Scene
makeBracket();

Scene
makeCarton();

Scene
makeCube();

Scene
makeTool();

Scene
makeCorridor();

/** \brief The corridor without its pillars. */
Scene
makePlainCorridor();

/** \brief Four corridors around a block. */
Scene
makeCorridorLoop();

Scene
makeStairs();

Scene
makeRoom();

Scene
makeGround();

Scene
makeCar();

Scene
makeTree();

Scene
makeStreet();

Scene
makeOfficeFloor();

Scene
makeForest();

Scene
makeBareGround();

/** \brief A straight tube with a flat floor. */
Scene
makeTunnel();

} // namespace bayesian_icp::simulator
