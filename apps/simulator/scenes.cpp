#include "simulator/scenes.h"

#include "simulator/scene_parts.h"

#include <algorithm>
#include <limits>
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
    for (const auto& scenes_of :
         {objectScenes, workshopScenes, placeScenes, outdoorScenes, roadScenes})
      for (Scene& scene : scenes_of())
        all.push_back(std::move(scene));
    return all;
  }();
  return scenes;
}

} // namespace

double
ScenePart::distanceIfBelow(double other, const Vector3d& point) const
{
  const bool is_far = bounds.squaredExteriorDistance(point) > other * other;
  return is_far ? other : std::min(other, distance(point));
}

double
Scene::distance(const Vector3d& point) const
{
  double nearest = std::numeric_limits<double>::infinity();
  for (const ScenePart& part : parts)
    nearest = part.distanceIfBelow(nearest, point);
  return nearest;
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
