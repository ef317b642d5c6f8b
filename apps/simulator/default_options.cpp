#include "simulator/simulation.h"

namespace bayesian_icp::simulator {

using Eigen::Vector3d;

namespace {

/** \brief A camera in front of things whose frame is the object's, the source taken
 * from another side and then moved by a known offset. */
SimulationOptions
aroundObject(const Vector3d& target_eye, const Vector3d& source_eye)
{
  SimulationOptions options;
  options.target_view = {target_eye, Vector3d::Zero()};
  options.source_view = {source_eye, Vector3d::Zero()};
  options.frame = CloudFrame::Object;
  options.offset << 0.03, -0.02, 0.015, 0.08, -0.06, 0.12;
  return options;
}

/** \brief A sensor that is carried on a little between target and source. */
SimulationOptions
carriedOn(const SensorOptions& sensor, const View& target_view, const View& source_view)
{
  SimulationOptions options;
  options.sensor = sensor;
  options.target_view = target_view;
  options.source_view = source_view;
  options.frame = CloudFrame::Sensor;
  return options;
}

/** \brief A LiDAR that looks down more than up. */
SensorOptions
downwardLidar()
{
  SensorOptions options;
  options.kind = SensorKind::Lidar;
  options.max_range = 30.0;
  options.lidar.rings = 32;
  options.lidar.min_elevation = -30.0;
  options.lidar.max_elevation = 10.0;
  return options;
}

/** \brief A LiDAR of 16 rings on a roof that goes on along the x axis by 1 m and turns
 * a little to the left. */
SimulationOptions
driven(const Vector3d& eye)
{
  return carriedOn(carLidar(16),
                   {eye, eye + Vector3d::UnitX()},
                   {eye + Vector3d(1.0, 0.02, 0.0), eye + Vector3d(2.0, 0.06, 0.0)});
}

SimulationOptions
optionsFor(const std::string& scene)
{
  const SensorOptions camera;
  if (scene == "corridor" || scene == "plain_corridor")
    return carriedOn(camera,
                     {{0.0, 0.0, 1.3}, {3.0, 0.0, 1.1}},
                     {{0.15, 0.03, 1.3}, {3.15, 0.15, 1.15}});
  if (scene == "room")
    return carriedOn(downwardLidar(),
                     {{0.0, 0.0, 1.2}, {1.0, 0.0, 1.2}},
                     {{0.15, 0.1, 1.2}, {1.15, 0.2, 1.2}});
  if (scene == "stairs")
    return carriedOn(camera,
                     {{-1.3, 0.0, 1.4}, {0.6, 0.0, 0.4}},
                     {{-1.2, 0.05, 1.4}, {0.7, 0.0, 0.4}});
  if (scene == "ground")
    return carriedOn(downwardLidar(),
                     {{0.0, 0.0, 1.8}, {1.0, 0.0, 1.8}},
                     {{0.4, 0.05, 1.8}, {1.4, 0.1, 1.8}});
  if (scene == "car" || scene == "tree")
    return carriedOn(downwardLidar(),
                     {{-3.5, -3.0, 1.8}, {-2.5, -2.0, 1.8}},
                     {{-3.1, -2.9, 1.8}, {-2.2, -1.8, 1.8}});
  if (scene == "street" || scene == "tunnel" || scene == "tunnel_cabinets")
    return driven({0.0, -1.5, 1.8});
  if (scene == "forest" || scene == "bare_ground")
    return driven({0.0, 0.0, 2.0});
  if (scene == "corridor_loop")
    return driven({-1.0, -4.0, 1.0});
  if (scene == "office_floor")
    return driven({0.0, 0.0, 1.0});
  if (scene == "table_top")
    return aroundObject({0.0, -0.2, 0.5}, {0.04, -0.22, 0.5});
  if (scene == "table" || scene == "table_plate")
    return aroundObject({0.0, -1.2, 0.9}, {0.3, -1.15, 0.9});
  if (scene == "bowl")
    return aroundObject({0.0, -0.7, 0.45}, {0.18, -0.68, 0.45});
  return aroundObject({0.0, -0.62, 0.32}, {0.16, -0.6, 0.32});
}

} // namespace

SimulationOptions
defaultOptions(const std::string& scene)
{
  SimulationOptions options = optionsFor(makeScene(scene).name);
  options.scene = scene;
  return options;
}

} // namespace bayesian_icp::simulator
