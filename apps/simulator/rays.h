/** \file
 * \brief Where a ray meets a scene (sphere tracing), and the surface normal there.
 */
#pragma once

#include "simulator/scenes.h"

#include <Eigen/Core>

#include <optional>

namespace bayesian_icp::simulator {

/** \brief A half line in the world frame [m]. */
struct Ray {
  Eigen::Vector3d origin;
  /** Unit vector. */
  Eigen::Vector3d direction;
};

/** \brief Distance along the ray to the first surface [m], to about 1e-6 m.
 * \return nothing if the ray meets no surface within \p max_range [m] */
std::optional<double>
castRay(const Scene& scene, const Ray& ray, double max_range);

/** \brief Unit normal of the surface at \p point (world frame), out of the solid. */
Eigen::Vector3d
surfaceNormal(const Scene& scene, const Eigen::Vector3d& point);

} // namespace bayesian_icp::simulator
