/** \file
 * \brief Things that stand on the ground out of doors.
 */
#include "simulator/scene_parts.h"

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

} // namespace

double
carDistance(const Vector3d& point)
{
  return std::min({bodyDistance(point), cabinDistance(point), wheelDistance(point)});
}

std::vector<Scene>
outdoorScenes()
{
  return {{"car",
           "a car, 4.4 m x 1.8 m x 1.45 m, on the ground",
           "nothing",
           {floorPart("ground"),
            {"body", bodyDistance},
            {"cabin", cabinDistance},
            {"wheels", wheelDistance}}},
          {"tree",
           "a trunk, radius 0.2 m, 4 m high, on the ground",
           "rotation about the trunk",
           {floorPart("ground"), cylinder("trunk", Vector3d::Zero(), 0.2, 4.0)}}};
}

} // namespace bayesian_icp::simulator
