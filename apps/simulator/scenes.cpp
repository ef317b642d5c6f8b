#include "simulator/scenes.h"

#include "simulator/scene_parts.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace bayesian_icp::simulator {

using Eigen::Vector3d;

namespace {

using SceneMaker = Scene (*)();

const std::vector<std::pair<std::string, SceneMaker>>&
sceneMakers()
{
  static const std::vector<std::pair<std::string, SceneMaker>> makers = {
      {"bowl", makeBowl},
      {"can", makeCan},
      {"mug", makeMug},
      {"mug_hidden_handle", makeMugHiddenHandle},
      {"table_top", makeTableTop},
      {"table_plate", makeTablePlate},
      {"table", makeTable},
      {"box", makeBox},
      {"bracket", makeBracket},
      {"carton", makeCarton},
      {"cube", makeCube},
      {"tool", makeTool},
      {"corridor", makeCorridor},
      {"plain_corridor", makePlainCorridor},
      {"corridor_loop", makeCorridorLoop},
      {"stairs", makeStairs},
      {"room", makeRoom},
      {"ground", makeGround},
      {"car", makeCar},
      {"tree", makeTree},
      {"street", makeStreet},
      {"office_floor", makeOfficeFloor},
      {"forest", makeForest},
      {"bare_ground", makeBareGround},
      {"tunnel", makeTunnel}};
  return makers;
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

const std::string&
Scene::nearestPart(const Vector3d& point) const
{
  return std::min_element(parts.begin(),
                          parts.end(),
                          [&point](const ScenePart& a, const ScenePart& b) {
                            return a.distance(point) < b.distance(point);
                          })
      ->name;
}

const std::vector<std::string>&
sceneNames()
{
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& maker : sceneMakers())
      all.push_back(maker.first);
    return all;
  }();
  return names;
}

Scene
makeScene(const std::string& name)
{
  for (const auto& maker : sceneMakers())
    if (maker.first == name)
      return maker.second();
  throw std::invalid_argument("there is no scene '" + name +
                              "'; --list-scenes shows all");
}

} // namespace bayesian_icp::simulator
