/** \file
 * \brief The scenes that can be scanned, as signed distance functions in metres.
 *
 * The world frame has z up. Its origin lies on the object: in the middle of the height
 * of a bowl, can or mug, on its axis; in the middle of the upper side of a table; at
 * the foot of the other objects; on the floor elsewhere.
 */
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace bayesian_icp::simulator {

/** \brief Signed distance [m] of a point of the world frame [m] to a surface. */
using DistanceFunction = std::function<double(const Eigen::Vector3d&)>;

/** \brief A half line in the world frame [m]. */
struct Ray {
  Eigen::Vector3d origin;
  /** Unit vector. */
  Eigen::Vector3d direction;
};

/** \brief All of space. */
inline Eigen::AlignedBox3d
unbounded()
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {Eigen::Vector3d::Constant(-infinity), Eigen::Vector3d::Constant(infinity)};
}

/** \brief A named piece of a scene, such as the handle of a mug. */
struct ScenePart {
  std::string name;
  DistanceFunction distance;
  /** Holds all of the part [m]: what is far from it need not ask for the distance. */
  Eigen::AlignedBox3d bounds = unbounded();

  /** \brief Whether its bounds show that \p point is farther from the part than
   * \p other [m]. */
  bool
  isFarther(double other, const Eigen::Vector3d& point) const;
};

/** \brief The union of its parts. */
struct Scene {
  std::string name;
  /** One line for people. */
  std::string description;
  /** The motions that a registration of two scans cannot or can barely see. */
  std::string unobservable;
  std::vector<ScenePart> parts;

  /** \brief Signed distance to the nearest part [m]; a lower bound outside. */
  double
  distance(const Eigen::Vector3d& point) const;

  /** \brief Distance along the ray to the first surface [m], to about 1e-6 m, by sphere
   * tracing.
   * \return nothing if the ray meets no surface within \p max_range [m] */
  std::optional<double>
  castRay(const Ray& ray, double max_range) const;

  /** \brief Unit normal of the surface at \p point (world frame), out of the solid. */
  Eigen::Vector3d
  surfaceNormal(const Eigen::Vector3d& point) const;
};

/** \brief The names that makeScene() knows, in the order in which they are listed. */
std::vector<std::string>
sceneNames();

/** \brief The scene of this name.
 * \throws std::invalid_argument if there is no scene of this name */
Scene
makeScene(const std::string& name);

} // namespace bayesian_icp::simulator
