#include "simulator/scene_parts.h"

#include <bayesian_icp/random.h>

#include <algorithm>
#include <cmath>

namespace bayesian_icp::simulator {

using Eigen::Vector3d;

namespace {

double
bodyDistance(const Vector3d& point)
{
  return boxDistance(point, {-2.2, -0.9, 0.3}, {2.2, 0.9, 0.8});
}

/** \brief Cabin of the car: a prism along y whose front and rear windows slope. */
double
cabinDistance(const Vector3d& point)
{
  const double middle = boxDistance(point, {-1.6, -0.8, 0.8}, {1.3, 0.8, 1.45});
  // Planes through the lower edges of the windows, 45 and 60 degrees steep.
  const double front = std::sqrt(0.5) * ((point.x() - 1.3) + (point.z() - 0.8));
  const double rear = std::sqrt(0.75) * (-point.x() - 1.6) + 0.5 * (point.z() - 0.8);
  return std::max({middle, front, rear});
}

/** \brief All four wheels, 0.64 m high. */
double
wheelDistance(const Vector3d& point)
{
  constexpr double radius = 0.32;
  constexpr double width = 0.2;
  const Vector3d folded(
      std::abs(point.x()) - 1.35, std::abs(point.y()) - 0.7, point.z() - radius);
  return cylinderDistance(Vector3d(folded.x(), folded.z(), folded.y()), radius, width);
}

/** A car on the ground, 4.4 m x 1.8 m x 1.45 m, its front towards +x. */
double
carDistance(const Vector3d& point)
{
  return std::min({bodyDistance(point), cabinDistance(point), wheelDistance(point)});
}

double
between(double lowest, double highest, Random& random)
{
  return lowest + (highest - lowest) * random.uniform();
}

/** \brief A wave of length 1 and amplitude 1 made of parabolas, at most 8 steep: faster
 * than a sine, and the same everywhere. */
double
wave(double position)
{
  const double phase = position - std::round(position);
  return 8.0 * phase * (1.0 - 2.0 * std::abs(phase));
}

/** \brief Ground about z = 0: the sum of three waves in different directions.
 * \param[in] amplitude of the longest [m]; no point is higher than 1.75 times that
 * \param[in] wave_length of the longest [m] */
ScenePart
roughGround(double amplitude, double wave_length)
{
  const double steepest = 8.0 * 3.1 * amplitude / wave_length;
  const double shrink = 1.0 / std::sqrt(1.0 + steepest * steepest);
  return {"ground", [=](const Vector3d& point) {
            const double x = point.x() / wave_length;
            const double y = point.y() / wave_length;
            const double height =
                amplitude * (wave(x + 0.3 * y) + 0.5 * wave(1.9 * y - 0.7 * x + 0.2) +
                             0.25 * wave(3.1 * x + 2.3 * y + 0.3));
            return shrink * (point.z() - height);
          }};
}

/** \brief Upright cylinder with a round, lumpy crown at its upper end. */
ScenePart
leafyTree(const Vector3d& foot, double trunk_radius, double height, double crown_radius)
{
  constexpr double lump = 0.15;
  constexpr double k = 4.0;
  const double half = crown_radius + lump;
  return standing(
      "tree",
      foot,
      {2.0 * half, 2.0 * half, height + half},
      [=](const Vector3d& point) {
        const Vector3d p = point - Vector3d(0.0, 0.0, height);
        const double lumps =
            lump * std::sin(k * p.x()) * std::sin(k * p.y()) * std::sin(k * p.z());
        const double crown = (p.norm() - crown_radius - lumps) / (1.0 + k * lump);
        return std::min(cylinderDistance(point, trunk_radius, height), crown);
      });
}

/** \brief Upright cylinder. */
ScenePart
pole(const std::string& name, const Vector3d& foot, double radius, double height)
{
  return standing(
      name, foot, {2.0 * radius, 2.0 * radius, height}, [=](const Vector3d& point) {
        return cylinderDistance(point, radius, height);
      });
}

/** \brief Block whose front, towards -y, has windows set back by 0.25 m. */
double
buildingDistance(const Vector3d& point, const Vector3d& size)
{
  constexpr double between_windows = 2.6;
  constexpr double storey = 3.2;
  const double front = -0.5 * size.y();
  const Vector3d half(0.5 * size.x(), 0.5 * size.y(), 0.0);
  const double block = boxDistance(point, -half, half + Vector3d(0.0, 0.0, size.z()));
  const Vector3d folded(point.x() -
                            between_windows * std::round(point.x() / between_windows),
                        point.y() - front,
                        point.z() - storey * std::floor(point.z() / storey));
  // Reaches out of the front, so that a ray does not end where the front was.
  const double window = boxDistance(folded, {-0.6, -1.0, 0.9}, {0.6, 0.25, 2.4});
  return std::max(block, -window);
}

/** \brief Buildings of different width, height and distance from the road, some with a
 * gap between them.
 * \param[in] side 1 or -1, the sign of their y */
void
addBuildings(double side, Random& random, std::vector<ScenePart>& parts)
{
  for (double x = -75.0; x < 75.0;) {
    const double width = between(10.0, 18.0, random);
    const Vector3d size(width, 10.0, between(7.0, 14.0, random));
    const double front = between(8.5, 9.5, random);
    parts.push_back(
        standing("building",
                 {x + 0.5 * width, side * (front + 0.5 * size.y()), 0.0},
                 size,
                 [side, size](const Vector3d& p) {
                   return buildingDistance({p.x(), side * p.y(), p.z()}, size);
                 }));
    x += width + (random.uniform() < 0.4 ? 3.0 : 0.0);
  }
}

/** \brief Parked cars, trees and poles.
 * \param[in] side 1 or -1, the sign of their y */
void
addRoadside(double side, Random& random, std::vector<ScenePart>& parts)
{
  for (double x = -60.0; x < 60.0; x += between(6.0, 10.0, random)) {
    const double y = side * between(4.1, 4.25, random);
    if (random.uniform() < 0.7)
      parts.push_back(standing("car", {x, y, 0.0}, {4.4, 1.8, 1.45}, carDistance));
  }
  for (double x = -58.0; x < 60.0; x += between(9.0, 14.0, random)) {
    const double trunk_radius = between(0.12, 0.27, random);
    const double height = between(3.5, 5.0, random);
    const double crown_radius = between(1.2, 1.8, random);
    parts.push_back(
        leafyTree({x, side * 6.0, 0.0}, trunk_radius, height, crown_radius));
  }
  for (double x = -65.0; x < 65.0; x += between(20.0, 28.0, random))
    parts.push_back(pole("pole", {x, side * 5.6, 0.0}, 0.08, 6.0));
}

std::vector<ScenePart>
street()
{
  const auto pavement = [](const Vector3d& point) {
    return boxDistance(Vector3d(0.0, std::abs(point.y()), point.z()),
                       Vector3d(-1.0, 5.2, -1.0),
                       Vector3d(1.0, 40.0, 0.12));
  };
  std::vector<ScenePart> parts = {floorPart("ground"), {"pavement", pavement}};
  Random random(1, 0);
  for (const double side : {-1.0, 1.0}) {
    addBuildings(side, random, parts);
    addRoadside(side, random, parts);
  }
  return parts;
}

std::vector<ScenePart>
forest()
{
  constexpr int num_trunks = 160;
  std::vector<ScenePart> parts = {roughGround(0.2, 20.0)};
  Random random(2, 0);
  for (int i = 0; i < num_trunks; ++i) {
    const double x = between(-40.0, 40.0, random);
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    const Vector3d foot(x, side * between(2.5, 40.0, random), -1.0);
    parts.push_back(pole("trunk", foot, between(0.1, 0.3, random), 13.0));
  }
  return parts;
}

/** \brief The wall of a straight tube along x. */
double
tunnelDistance(const Vector3d& point)
{
  constexpr double radius = 4.5;
  constexpr double height_of_axis = 1.5;
  return radius - Eigen::Vector2d(point.y(), point.z() - height_of_axis).norm();
}

std::vector<ScenePart>
tunnelWithCabinets()
{
  std::vector<ScenePart> parts = {floorPart(), {"wall", tunnelDistance}};
  Random random(3, 0);
  for (const double side : {-1.0, 1.0})
    for (double x = -75.0; x < 75.0; x += between(10.0, 20.0, random)) {
      const Vector3d size(between(0.4, 1.0, random), 1.0, between(0.8, 1.4, random));
      parts.push_back(standing(
          "cabinet", {x, 4.6 * side, 0.4}, size, [size](const Vector3d& point) {
            const Vector3d half(0.5 * size.x(), 0.5 * size.y(), 0.0);
            return boxDistance(point, -half, half + Vector3d(0.0, 0.0, size.z()));
          }));
    }
  return parts;
}

} // namespace

std::vector<Scene>
outdoorScenes()
{
  return {
      {"car",
       "a car, 4.4 m x 1.8 m x 1.45 m, on the ground",
       "nothing",
       {floorPart("ground"),
        {"body", bodyDistance},
        {"cabin", cabinDistance},
        {"wheels", wheelDistance}}},
      {"tree",
       "a trunk, radius 0.2 m, 4 m high, on the ground",
       "rotation about the trunk",
       {floorPart("ground"), cylinder("trunk", Vector3d::Zero(), 0.2, 4.0)}},
      {"street",
       "a street, 150 m long and 17 m wide, with houses, parked cars, trees and poles",
       "nothing",
       street()},
      {"forest",
       "160 trunks on uneven ground, 80 m x 80 m, and a track between them",
       "nothing",
       forest()},
      {"bare_ground",
       "endless ground, rough by 0.05 m over 15 m",
       "translation along x and y and rotation about z, but for the roughness",
       {roughGround(0.05, 15.0)}},
      {"tunnel",
       "an endless smooth tube, radius 4.5 m, with a flat floor 1.5 m below its axis",
       "translation along it",
       {floorPart(), {"wall", tunnelDistance}}},
      {"tunnel_cabinets",
       "the tunnel with cabinets at both walls, 0.3 m deep, every 10 to 20 m",
       "nothing",
       tunnelWithCabinets()}};
}

} // namespace bayesian_icp::simulator
