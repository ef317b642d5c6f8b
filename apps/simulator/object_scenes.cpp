/** \file
 * \brief Scenes of the size of a hand or a table.
 */
#include "simulator/household_objects.h"
#include "simulator/scene_parts.h"

namespace bayesian_icp::simulator {

using Eigen::Vector3d;

namespace {

ScenePart
tableTop()
{
  return box("table top", Vector3d(-0.6, -0.4, -0.03), Vector3d(0.6, 0.4, 0.0));
}

/** \brief Mug with its handle on the +x side (visible from -y), or on the +y side. */
std::vector<ScenePart>
mugParts(const Vector3d& origin, bool handle_to_y)
{
  const auto handle = [handle_to_y](const Vector3d& point) {
    return mugHandleDistance(handle_to_y ? Vector3d(point.y(), -point.x(), point.z())
                                         : point);
  };
  return {{"mug body", movedTo(origin, mugBodyDistance)},
          {"mug handle", movedTo(origin, handle)}};
}

Scene
mug(bool handle_to_y)
{
  const Vector3d origin(0.0, 0.0, -0.5 * mug_height);
  return {handle_to_y ? "the same mug, turned so that its handle is behind it"
                      : "a mug, radius 40 mm, 100 mm high, handle in full view",
          handle_to_y ? "rotation about its vertical axis" : "nothing",
          mugParts(origin, handle_to_y)};
}

} // namespace

Scene
makeBowl()
{
  return {"a bowl, 170 mm wide and 76 mm high",
          "rotation about its vertical axis",
          {{"bowl", movedTo(Vector3d(0.0, 0.0, -0.5 * bowl_height), bowlDistance)}}};
}

Scene
makeCan()
{
  return {"a soda can, radius 33 mm, 120 mm high",
          "rotation about its vertical axis",
          {{"can", movedTo(Vector3d(0.0, 0.0, -0.5 * can_height), canDistance)}}};
}

Scene
makeMug()
{
  return mug(false);
}

Scene
makeMugHiddenHandle()
{
  return mug(true);
}

Scene
makeTableTop()
{
  return {"the empty middle of a table, its edges out of view",
          "translation along x and y, rotation about z",
          {tableTop()}};
}

Scene
makeTablePlate()
{
  return {"an empty plate, 1.0 m x 0.8 m, 40 mm thick",
          "nothing, but its edges alone hold x, y and the rotation about z",
          {box("plate", {-0.5, -0.4, -0.04}, {0.5, 0.4, 0.0})}};
}

Scene
makeTable()
{
  Scene scene{"a table, 1.2 m x 0.8 m, with a mug, a can, a bowl, a carton and a book",
              "nothing",
              mugParts(Vector3d(-0.08, -0.2, 0.0), false)};
  scene.parts.push_back(tableTop());
  scene.parts.push_back({"can", movedTo(Vector3d(-0.3, 0.12, 0.0), canDistance)});
  scene.parts.push_back({"bowl", movedTo(Vector3d(0.22, -0.12, 0.0), bowlDistance)});
  scene.parts.push_back(box("carton", {0.05, 0.12, 0.0}, {0.21, 0.18, 0.22}));
  scene.parts.push_back(box("book", {-0.5, -0.25, 0.0}, {-0.29, -0.1, 0.025}));
  return scene;
}

} // namespace bayesian_icp::simulator
