#include "simulator/scene_parts.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp::simulator {

using Eigen::Vector3d;

namespace {

/** \brief Endless walls at both sides of the plane y = 0. */
ScenePart
wallsAlong(double half_width)
{
  return {"walls", [half_width](const Vector3d& point) {
            return half_width - std::abs(point.y());
          }};
}

/** \brief Floor, ceiling and walls of a hall about the z axis, seen from inside. */
ScenePart
hall(const std::string& name, const Vector3d& half_size)
{
  const Vector3d lower(-half_size.x(), -half_size.y(), 0.0);
  const Vector3d upper(half_size.x(), half_size.y(), 2.0 * half_size.z());
  return {name, [lower, upper](const Vector3d& point) {
            return -boxDistance(point, lower, upper);
          }};
}

/** \brief Plate on four square legs that stands on the floor: a table or a stool. */
ScenePart
plateOnLegs(const std::string& name,
            const Vector3d& centre_of_plate,
            double half_length,
            double half_width)
{
  const auto distance = [=](const Vector3d& point) {
    const Vector3d p = point - centre_of_plate;
    const double plate = boxDistance(
        p, {-half_length, -half_width, -0.04}, {half_length, half_width, 0.0});
    const Vector3d folded(std::abs(p.x()), std::abs(p.y()), p.z());
    const double leg = boxDistance(
        folded,
        Vector3d(half_length - 0.08, half_width - 0.08, -centre_of_plate.z()),
        Vector3d(half_length - 0.03, half_width - 0.03, -0.02));
    return std::min(plate, leg);
  };
  return {name, distance};
}

/** \brief Moves the point to the half room that stands for all rooms of office_floor.
 */
Vector3d
foldedIntoRoom(const Vector3d& point)
{
  constexpr double room_width = 4.0;
  const double along = point.x() - room_width * std::round(point.x() / room_width);
  return {std::abs(along), std::abs(point.y()), point.z()};
}

/** \brief The empty space of a door of office_floor. */
double
doorwayDistance(const Vector3d& folded)
{
  return boxDistance(folded, {-0.45, 0.0, -1.0}, {0.45, 2.0, 2.1});
}

/** \brief The walls of office_floor along its corridor, with a door to each room, and
 * between its rooms. */
double
partitionDistance(const Vector3d& point)
{
  const Vector3d folded = foldedIntoRoom(point);
  const double beside_corridor =
      boxDistance(folded, {-1.0, 1.2, 0.0}, {2.0, 1.32, 2.8});
  const double between_rooms = boxDistance(folded, {1.94, 1.2, 0.0}, {2.06, 6.3, 2.8});
  return std::min(std::max(beside_corridor, -doorwayDistance(folded)), between_rooms);
}

/** \brief The frames of its doors, which stand out by 0.03 m. */
double
doorFrameDistance(const Vector3d& point)
{
  const Vector3d folded = foldedIntoRoom(point);
  const double outside = boxDistance(folded, {-0.53, 1.17, 0.0}, {0.53, 1.35, 2.18});
  return std::max(outside, -doorwayDistance(folded));
}

/** \brief A desk and a pillar in every room, in different places. */
void
addFurniture(std::vector<ScenePart>& parts)
{
  for (int room = 0; room < 18; ++room) {
    const bool is_right = room % 2 == 1;
    const double side = is_right ? -1.0 : 1.0;
    const double x = 2.0 * (is_right ? room - 1 : room) - 16.0;
    const Vector3d desk(
        x - 0.8 + 0.3 * (room % 5), side * (3.2 + 0.4 * (room % 4)), 0.74);
    parts.push_back(plateOnLegs("desk", desk, 0.8, 0.4));
    parts.back().bounds = {desk - Vector3d(0.8, 0.4, 0.74),
                           desk + Vector3d(0.8, 0.4, 0.0)};
    const Vector3d pillar(x + 1.5, side * (1.7 + 0.5 * (room % 3)), 0.0);
    parts.push_back(standing("pillar", pillar, {0.4, 0.4, 2.8}, [](const Vector3d& p) {
      return boxDistance(p, {-0.2, -0.2, 0.0}, {0.2, 0.2, 2.8});
    }));
  }
}

std::vector<ScenePart>
officeFloor()
{
  std::vector<ScenePart> parts = {hall("outer walls", {18.0, 6.3, 1.4}),
                                  {"partitions", partitionDistance},
                                  {"door frames", doorFrameDistance}};
  addFurniture(parts);
  return parts;
}

std::vector<ScenePart>
plainCorridor()
{
  return {floorPart(),
          {"ceiling", [](const Vector3d& point) { return 2.5 - point.z(); }},
          wallsAlong(1.0)};
}

/** \brief Both walls carry one flat pillar a period. */
double
corridorPillarDistance(const Vector3d& point)
{
  constexpr double period = 1.5;
  const double along = point.x() - period * std::round(point.x() / period);
  return boxDistance(Vector3d(along, std::abs(point.y()), point.z()),
                     Vector3d(-0.1, 0.94, 0.0),
                     Vector3d(0.1, 1.0, 2.5));
}

std::vector<ScenePart>
corridor()
{
  std::vector<ScenePart> parts = plainCorridor();
  parts.push_back({"pillars", corridorPillarDistance});
  return parts;
}

/** \brief Four corridors around a block. */
std::vector<ScenePart>
corridorLoop()
{
  std::vector<ScenePart> parts = {hall("outer walls", {7.0, 5.0, 1.25}),
                                  box("block", {-5.0, -3.0, 0.0}, {5.0, 3.0, 2.5})};
  for (const double x : {-4.2, -2.9, -1.1, 1.9, 4.3}) {
    parts.push_back(box("pillar", {x, -3.0 - 0.12, 0.0}, {x + 0.25, -3.0, 2.5}));
    parts.push_back(box("cupboard", {-x, 5.0 - 0.35, 0.0}, {-x + 0.9, 5.0, 1.9}));
  }
  for (const double y : {-2.3, 0.4, 1.7}) {
    parts.push_back(box("pillar", {7.0 - 0.15, y, 0.0}, {7.0, y + 0.3, 2.5}));
    parts.push_back(box("cupboard", {-5.0 - 0.3, y, 0.0}, {-5.0, y + 0.7, 1.8}));
  }
  return parts;
}

std::vector<ScenePart>
stairs()
{
  constexpr double rise = 0.17;
  constexpr double going = 0.28;
  constexpr int num_steps = 8;
  std::vector<ScenePart> parts = {floorPart(), wallsAlong(0.6)};
  for (int step = 0; step < num_steps; ++step)
    parts.push_back(box("step " + std::to_string(step + 1),
                        Vector3d(step * going, -0.6, 0.0),
                        Vector3d(num_steps * going + 1.0, 0.6, (step + 1) * rise)));
  return parts;
}

std::vector<ScenePart>
room()
{
  return {hall("walls", {2.5, 2.0, 1.25}),
          plateOnLegs("table", {1.2, 0.6, 0.74}, 0.7, 0.4),
          plateOnLegs("stool by the table", {1.2, -0.15, 0.45}, 0.2, 0.2),
          plateOnLegs("stool by the bed", {-0.3, -0.9, 0.45}, 0.2, 0.2),
          box("cupboard", {-2.5, 0.8, 0.0}, {-1.9, 2.0, 1.9}),
          box("bed", {-2.5, -2.0, 0.0}, {-0.5, -1.1, 0.5}),
          box("shelf", {0.6, -2.0, 1.3}, {2.1, -1.7, 1.34}),
          cylinder("bin", {2.2, -1.6, 0.0}, 0.15, 0.4)};
}

} // namespace

std::vector<Scene>
placeScenes()
{
  return {
      {"corridor",
       "an endless corridor, 2 m wide and 2.5 m high, a flat pillar every 1.5 m",
       "translation along it: held by the pillars only, and up to their period",
       corridor()},
      {"plain_corridor",
       "an endless corridor, 2 m wide and 2.5 m high, with smooth walls",
       "translation along it",
       plainCorridor()},
      {"corridor_loop",
       "corridors around a block, 14 m x 10 m, 2 m wide and 2.5 m high, with cupboards "
       "and pillars at uneven distances",
       "nothing, but little holds the motion along a corridor",
       corridorLoop()},
      {"stairs",
       "eight steps, rise 0.17 m, going 0.28 m, between walls 1.2 m apart",
       "nothing, but a shift by one step is nearly as good",
       stairs()},
      {"room",
       "a room, 5 m x 4 m x 2.5 m, with table, stools, cupboard, bed, shelf and bin",
       "nothing",
       room()},
      {"office_floor",
       "a floor of 36 m x 12.6 m: a corridor 2.4 m wide, on each side nine rooms with "
       "open doors, pillars and desks",
       "nothing, but a shift by one room is nearly as good",
       officeFloor()},
      {"ground",
       "an endless plane",
       "translation along x and y, rotation about z",
       {floorPart()}}};
}

} // namespace bayesian_icp::simulator
