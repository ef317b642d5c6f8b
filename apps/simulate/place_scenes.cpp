/** \file
 * \brief Scenes to walk or drive through.
 */
#include "scene_parts.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp {
namespace simulator {

using Eigen::Vector3d;

namespace {

/** \brief Plate on four square legs that stands on the floor: a table or a stool. */
ScenePart
plateOnLegs(const std::string& name,
            const Vector3d& centre_of_plate,
            double half_length,
            double half_width)
{
  const auto distance = [=](const Vector3d& point) {
    const Vector3d p = point - centre_of_plate;
    const double plate = boxDistance(p - Vector3d(0.0, 0.0, -0.02),
                                     Vector3d(half_length, half_width, 0.02));
    const Vector3d folded(std::abs(p.x()), std::abs(p.y()), p.z());
    const double leg = boxDistance(
        folded,
        Vector3d(half_length - 0.08, half_width - 0.08, -centre_of_plate.z()),
        Vector3d(half_length - 0.03, half_width - 0.03, -0.02));
    return std::min(plate, leg);
  };
  return {name, distance};
}

} // namespace

Scene
makeCorridor()
{
  constexpr double period = 1.5;
  const auto pillars = [](const Vector3d& point) {
    // Both walls carry one pillar a period: fold the point onto the nearest of them.
    const double along = point.x() - period * std::round(point.x() / period);
    return boxDistance(Vector3d(along, std::abs(point.y()), point.z()),
                       Vector3d(-0.1, 0.94, 0.0),
                       Vector3d(0.1, 1.0, 2.5));
  };
  return {"an endless corridor, 2 m wide and 2.5 m high, a flat pillar every 1.5 m",
          "translation along it: held by the pillars only, and up to their period",
          {floorPart(),
           {"ceiling", [](const Vector3d& point) { return 2.5 - point.z(); }},
           {"walls", [](const Vector3d& point) { return 1.0 - std::abs(point.y()); }},
           {"pillars", pillars}}};
}

Scene
makePlainCorridor()
{
  return {"an endless corridor, 2 m wide and 2.5 m high, with smooth walls",
          "translation along it",
          {floorPart(),
           {"ceiling", [](const Vector3d& point) { return 2.5 - point.z(); }},
           {"walls", [](const Vector3d& point) { return 1.0 - std::abs(point.y()); }}}};
}

Scene
makeStairs()
{
  constexpr double rise = 0.17;
  constexpr double going = 0.28;
  constexpr int num_steps = 8;
  Scene scene{"eight steps, rise 0.17 m, going 0.28 m, between walls 1.2 m apart",
              "nothing, but a shift by one step is nearly as good",
              {floorPart(), {"walls", [](const Vector3d& point) {
                               return 0.6 - std::abs(point.y());
                             }}}};
  for (int step = 0; step < num_steps; ++step)
    scene.parts.push_back(
        box("step " + std::to_string(step + 1),
            Vector3d(step * going, -0.6, 0.0),
            Vector3d(num_steps * going + 1.0, 0.6, (step + 1) * rise)));
  return scene;
}

Scene
makeRoom()
{
  const Vector3d half_size(2.5, 2.0, 1.25);
  const auto walls = [half_size](const Vector3d& point) {
    return -boxDistance(point - Vector3d(0.0, 0.0, 1.25), half_size);
  };
  const auto bin = [](const Vector3d& point) {
    return cylinderDistance(point, 0.15, 0.4);
  };
  return {"a room, 5 m x 4 m x 2.5 m, with table, stools, cupboard, bed, shelf and bin",
          "nothing",
          {{"walls", walls},
           plateOnLegs("table", Vector3d(1.2, 0.6, 0.74), 0.7, 0.4),
           plateOnLegs("stool by the table", Vector3d(1.2, -0.15, 0.45), 0.2, 0.2),
           plateOnLegs("stool by the bed", Vector3d(-0.3, -0.9, 0.45), 0.2, 0.2),
           box("cupboard", {-2.5, 0.8, 0.0}, {-1.9, 2.0, 1.9}),
           box("bed", {-2.5, -2.0, 0.0}, {-0.5, -1.1, 0.5}),
           box("shelf", {0.6, -2.0, 1.3}, {2.1, -1.7, 1.34}),
           {"bin", movedTo(Vector3d(2.2, -1.6, 0.0), bin)}}};
}

Scene
makeGround()
{
  return {
      "an endless plane", "translation along x and y, rotation about z", {floorPart()}};
}

} // namespace simulator
} // namespace bayesian_icp
