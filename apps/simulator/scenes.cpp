#include "simulator/scenes.h"

#include "simulator/scene_parts.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace bayesian_icp::simulator {

using Eigen::Vector3d;

namespace {

const std::vector<Scene>&
allScenes()
{
  static const std::vector<Scene> scenes = [] {
    std::vector<Scene> all;
    for (const auto& scenes_of : {objectScenes, placeScenes, outdoorScenes})
      for (Scene& scene : scenes_of())
        all.push_back(std::move(scene));
    return all;
  }();
  return scenes;
}

bool
meets(const Eigen::AlignedBox3d& box, const Ray& ray, double max_range)
{
  double enter = 0.0;
  double leave = max_range;
  for (int axis = 0; axis < 3; ++axis) {
    const double first = (box.min()[axis] - ray.origin[axis]) / ray.direction[axis];
    const double second = (box.max()[axis] - ray.origin[axis]) / ray.direction[axis];
    enter = std::max(enter, std::min(first, second));
    leave = std::min(leave, std::max(first, second));
  }
  return enter <= leave;
}

/** \brief A part that a ray may meet, and the range [m] before which it does not. */
struct PartAhead {
  const ScenePart* part;
  double free_range;
};

/** \brief The parts that the ray may meet within a range [m]. */
std::vector<PartAhead>
partsAlong(const Scene& scene, const Ray& ray, double max_range)
{
  std::vector<PartAhead> parts;
  for (const ScenePart& part : scene.parts)
    if (meets(part.bounds, ray, max_range))
      parts.push_back({&part, 0.0});
  return parts;
}

} // namespace

bool
ScenePart::isFarther(double other, const Vector3d& point) const
{
  return bounds.squaredExteriorDistance(point) > other * other;
}

double
Scene::distance(const Vector3d& point) const
{
  double nearest = std::numeric_limits<double>::infinity();
  for (const ScenePart& part : parts)
    if (!part.isFarther(nearest, point))
      nearest = std::min(nearest, part.distance(point));
  return nearest;
}

std::optional<double>
Scene::castRay(const Ray& ray, double max_range) const
{
  constexpr double hit_distance = 1e-6;
  // Grazing rays approach geometrically; a plane seen at 0.3 degrees takes 3000 steps.
  constexpr int max_steps = 4000;
  std::vector<PartAhead> parts = partsAlong(*this, ray, max_range);
  double range = 0.0;
  for (int step = 0; step < max_steps && range <= max_range; ++step) {
    const Vector3d point = ray.origin + range * ray.direction;
    double clearance = std::numeric_limits<double>::infinity();
    for (PartAhead& ahead : parts) {
      // No distance changes by more than the ray advances.
      if (ahead.free_range - range > clearance ||
          ahead.part->isFarther(clearance, point))
        continue;
      const double distance = ahead.part->distance(point);
      ahead.free_range = range + distance;
      clearance = std::min(clearance, distance);
    }
    if (clearance < hit_distance)
      return range;
    range += clearance;
  }
  return std::nullopt;
}

Vector3d
Scene::surfaceNormal(const Vector3d& point) const
{
  constexpr double half_step = 1e-6;
  Vector3d gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d step = half_step * Vector3d::Unit(axis);
    gradient[axis] = distance(point + step) - distance(point - step);
  }
  return gradient.normalized();
}

std::vector<std::string>
sceneNames()
{
  std::vector<std::string> names;
  for (const Scene& scene : allScenes())
    names.push_back(scene.name);
  return names;
}

Scene
makeScene(const std::string& name)
{
  for (const Scene& scene : allScenes())
    if (scene.name == name)
      return scene;
  throw std::invalid_argument("there is no scene '" + name +
                              "'; --list-scenes shows all");
}

} // namespace bayesian_icp::simulator
