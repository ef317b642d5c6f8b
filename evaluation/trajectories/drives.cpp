#include "trajectories/drives.h"

#include "simulator/simulation.h"
#include "study/named.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

namespace bayesian_icp::evaluate {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using simulator::View;

namespace {

constexpr double pi = 3.14159265358979323846;

/** A way through a scene: the view at \p part of it, 0 to 1. */
struct Drive {
  std::string name;
  std::string scene;
  simulator::SensorOptions sensor;
  std::function<View(double part)> view;
};

simulator::SensorOptions
robotLidar()
{
  simulator::SensorOptions sensor = simulator::carLidar(16);
  sensor.min_range = 0.3;
  return sensor;
}

simulator::SensorOptions
smallCamera()
{
  simulator::SensorOptions sensor;
  sensor.camera.width = 320;
  sensor.camera.height = 240;
  return sensor;
}

/** 70 m between parked cars, swerving by 0.8 m. */
View
alongStreet(double part)
{
  const double x = -35.0 + 70.0 * part;
  const Vector3d eye(x, -1.5 + 0.8 * std::sin(x / 10.0), 1.8);
  return {eye, eye + Vector3d(1.0, 0.08 * std::cos(x / 10.0), 0.0)};
}

/** Once around the middle of corridor_loop, 38 m, corners with a radius of 1 m. */
View
aroundBlock(double part)
{
  constexpr double half_length = 6.0, half_width = 4.0, radius = 1.0;
  const double long_side = 2.0 * (half_length - radius);
  const double short_side = 2.0 * (half_width - radius), arc = 0.5 * pi * radius;
  double way = part * 2.0 * (long_side + short_side + 2.0 * arc);
  Vector3d eye(-half_length + radius, -half_width, 1.0);
  double heading = 0.0;
  for (const double side : {long_side, short_side, long_side, short_side}) {
    const Vector3d ahead(std::cos(heading), std::sin(heading), 0.0);
    const Vector3d left(-ahead.y(), ahead.x(), 0.0);
    const double straight = std::min(way, side);
    const double turn = std::clamp(way - side, 0.0, arc) / radius;
    eye += straight * ahead +
           radius * (std::sin(turn) * ahead + (1.0 - std::cos(turn)) * left);
    heading += turn;
    way -= side + arc;
    if (way <= 0.0)
      break;
  }
  return {eye, eye + Vector3d(std::cos(heading), std::sin(heading), 0.0)};
}

/** Along the corridor of office_floor and back, 14 m each way. */
View
toAndFro(double part)
{
  const double phase = 2.0 * pi * part;
  const Vector3d eye(-7.0 * std::cos(phase), 0.4 * std::sin(phase), 1.0);
  const double heading = 0.4 * std::sin(2.0 * phase);
  return {eye, eye + Vector3d(std::cos(heading), std::sin(heading), 0.0)};
}

/** Once around the middle of the room, looking across it. */
View
aroundRoom(double part)
{
  const double phase = 2.0 * pi * part;
  const Vector3d eye(
      1.3 * std::cos(phase), std::sin(phase), 1.3 + 0.1 * std::sin(3.0 * phase));
  return {eye, {-0.4 * std::cos(phase), -0.3 * std::sin(phase), 0.7}};
}

const std::vector<Drive>&
drives()
{
  static const std::vector<Drive> all = {
      {"street", "street", simulator::carLidar(32), alongStreet},
      {"corridor_loop", "corridor_loop", robotLidar(), aroundBlock},
      {"office_floor", "office_floor", robotLidar(), toAndFro},
      {"room_camera", "room", smallCamera(), aroundRoom}};
  return all;
}

} // namespace

std::vector<std::string>
driveNames()
{
  return namesOf(drives());
}

Recording
makeDrive(const std::string& name, std::uint64_t seed, std::size_t num_scans)
{
  const Drive* const drive = findNamed(drives(), name);
  if (drive == nullptr)
    throw std::invalid_argument("there is no drive '" + name + "'");
  Recording recording;
  recording.name = name;
  recording.quality = "exact";
  for (std::size_t k = 0; k < num_scans; ++k)
    recording.poses.push_back(simulator::sensorPose(
        drive->sensor.kind,
        drive->view(static_cast<double>(k) / static_cast<double>(num_scans - 1))));
  const auto scene =
      std::make_shared<const simulator::Scene>(simulator::makeScene(drive->scene));
  recording.read = [scene, sensor = drive->sensor, poses = recording.poses, seed](
                       std::size_t scan) {
    return simulator::scanScene(
               *scene, sensor, poses.at(scan), seed, static_cast<std::uint32_t>(scan))
        .points;
  };
  return recording;
}

} // namespace bayesian_icp::evaluate
