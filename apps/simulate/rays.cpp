#include "rays.h"

namespace bayesian_icp {
namespace simulator {

std::optional<double>
castRay(const Scene& scene, const Ray& ray, double max_range)
{
  constexpr double hit_distance = 1e-6;
  // Grazing rays approach geometrically; a plane seen at 0.3 degrees takes 3000 steps.
  constexpr int max_steps = 4000;
  double range = 0.0;
  for (int step = 0; step < max_steps && range <= max_range; ++step) {
    const double clearance = scene.distance(ray.origin + range * ray.direction);
    if (clearance < hit_distance)
      return range;
    range += clearance;
  }
  return std::nullopt;
}

Eigen::Vector3d
surfaceNormal(const Scene& scene, const Eigen::Vector3d& point)
{
  constexpr double half_step = 1e-6;
  Eigen::Vector3d gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d step = half_step * Eigen::Vector3d::Unit(axis);
    gradient[axis] = scene.distance(point + step) - scene.distance(point - step);
  }
  return gradient.normalized();
}

} // namespace simulator
} // namespace bayesian_icp
