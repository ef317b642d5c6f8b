/** \file
 * \brief The usual sensor, views, frame and offset for each scene.
 */
#include "simulator/simulation.h"

namespace bayesian_icp::simulator {

using Eigen::Vector3d;

namespace {

/** \brief A camera in front of things whose frame is the object's, the source taken
 * from another side and then moved by a known offset. */
SimulationOptions
cameraOnObject(const std::string& scene,
               const Vector3d& target_eye,
               const Vector3d& source_eye)
{
  SimulationOptions options;
  options.scene = scene;
  options.target_view = {target_eye, Vector3d::Zero()};
  options.source_view = {source_eye, Vector3d::Zero()};
  options.frame = CloudFrame::Object;
  options.offset << 0.03, -0.02, 0.015, 0.08, -0.06, 0.12;
  return options;
}

/** \brief A LiDAR that looks down more than up, carried on a little between target and
 * source. */
SimulationOptions
movingLidar(const std::string& scene, const View& target_view, const View& source_view)
{
  SimulationOptions options;
  options.scene = scene;
  options.sensor.kind = SensorKind::Lidar;
  options.sensor.max_range = 30.0;
  options.sensor.lidar.rings = 32;
  options.sensor.lidar.min_elevation = -30.0;
  options.sensor.lidar.max_elevation = 10.0;
  options.target_view = target_view;
  options.source_view = source_view;
  options.frame = CloudFrame::Sensor;
  return options;
}

/** \brief A LiDAR of 16 rings on a roof that goes on along the x axis by 1 m and turns
 * a little to the left. */
SimulationOptions
drivenLidar(const std::string& scene, const Vector3d& eye)
{
  SimulationOptions options;
  options.scene = scene;
  options.sensor = carLidar(16);
  options.target_view = {eye, eye + Vector3d::UnitX()};
  options.source_view = {eye + Vector3d(1.0, 0.02, 0.0),
                         eye + Vector3d(2.0, 0.06, 0.0)};
  options.frame = CloudFrame::Sensor;
  return options;
}

/** \brief A camera carried on a little between target and source. */
SimulationOptions
movingCamera(const std::string& scene, const View& target_view, const View& source_view)
{
  SimulationOptions options;
  options.scene = scene;
  options.target_view = target_view;
  options.source_view = source_view;
  options.frame = CloudFrame::Sensor;
  return options;
}

} // namespace

SimulationOptions
defaultOptions(const std::string& scene)
{
  makeScene(scene);
  if (scene == "corridor" || scene == "plain_corridor")
    return movingCamera(scene,
                        {{0.0, 0.0, 1.3}, {3.0, 0.0, 1.1}},
                        {{0.15, 0.03, 1.3}, {3.15, 0.15, 1.15}});
  if (scene == "room")
    return movingLidar(scene,
                       {{0.0, 0.0, 1.2}, {1.0, 0.0, 1.2}},
                       {{0.15, 0.1, 1.2}, {1.15, 0.2, 1.2}});
  if (scene == "stairs")
    return movingCamera(scene,
                        {{-1.3, 0.0, 1.4}, {0.6, 0.0, 0.4}},
                        {{-1.2, 0.05, 1.4}, {0.7, 0.0, 0.4}});
  if (scene == "ground")
    return movingLidar(
        scene, {{0.0, 0.0, 1.8}, {1.0, 0.0, 1.8}}, {{0.4, 0.05, 1.8}, {1.4, 0.1, 1.8}});
  if (scene == "car" || scene == "tree")
    return movingLidar(scene,
                       {{-3.5, -3.0, 1.8}, {-2.5, -2.0, 1.8}},
                       {{-3.1, -2.9, 1.8}, {-2.2, -1.8, 1.8}});
  if (scene == "street" || scene == "tunnel")
    return drivenLidar(scene, {0.0, -1.5, 1.8});
  if (scene == "forest" || scene == "bare_ground")
    return drivenLidar(scene, {0.0, 0.0, 2.0});
  if (scene == "corridor_loop")
    return drivenLidar(scene, {-1.0, -4.0, 1.0});
  if (scene == "office_floor")
    return drivenLidar(scene, {0.0, 0.0, 1.0});
  if (scene == "table_top")
    return cameraOnObject(scene, {0.0, -0.2, 0.5}, {0.04, -0.22, 0.5});
  if (scene == "table" || scene == "table_plate")
    return cameraOnObject(scene, {0.0, -1.2, 0.9}, {0.3, -1.15, 0.9});
  if (scene == "bowl")
    return cameraOnObject(scene, {0.0, -0.7, 0.45}, {0.18, -0.68, 0.45});
  return cameraOnObject(scene, {0.0, -0.62, 0.32}, {0.16, -0.6, 0.32});
}

} // namespace bayesian_icp::simulator
