#include "simulator/simulation.h"

#include <stdexcept>

namespace bayesian_icp::simulator {

using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

void
validateView(const Scene& scene, const View& view, const std::string& name)
{
  if (!view.eye.allFinite() || !view.look_at.allFinite())
    throw std::invalid_argument(name + "-eye and " + name + "-look-at must be finite");
  if ((view.look_at - view.eye).norm() < 1e-6)
    throw std::invalid_argument(name + "-look-at must differ from " + name + "-eye");
  if (scene.distance(view.eye) <= 0.0)
    throw std::invalid_argument(name + "-eye is inside a solid of the scene");
}

} // namespace

void
validate(const SimulationOptions& options)
{
  const Scene scene = makeScene(options.scene);
  validate(options.sensor);
  validateView(scene, options.target_view, "target");
  validateView(scene, options.source_view, "source");
  if (!options.offset.allFinite())
    throw std::invalid_argument("offset must be six finite numbers");
  if (!(options.sweep_motion >= 0.0 && options.sweep_motion <= 1.0))
    throw std::invalid_argument("sweep-motion must be within 0 and 1");
  if (options.sweep_motion > 0.0 && options.sensor.kind != SensorKind::Lidar)
    throw std::invalid_argument("sweep-motion is for a lidar, not a depth-camera");
}

Isometry3d
sensorPose(SensorKind kind, const View& view)
{
  const Vector3d forward = (view.look_at - view.eye).normalized();
  const bool is_vertical = forward.cross(Vector3d::UnitZ()).norm() < 1e-6;
  const Vector3d up_hint = is_vertical ? Vector3d::UnitY() : Vector3d::UnitZ();
  const Vector3d right = forward.cross(up_hint).normalized();
  const Vector3d up = right.cross(forward);
  Isometry3d T_world_sensor = Isometry3d::Identity();
  if (kind == SensorKind::DepthCamera)
    T_world_sensor.linear() << right, -up, forward;
  else
    T_world_sensor.linear() << forward, -right, up;
  T_world_sensor.translation() = view.eye;
  return T_world_sensor;
}

ScanPair
simulate(const SimulationOptions& options)
{
  validate(options);
  const Scene scene = makeScene(options.scene);
  const Isometry3d T_world_target_sensor =
      sensorPose(options.sensor.kind, options.target_view);
  const Isometry3d T_world_source_sensor =
      sensorPose(options.sensor.kind, options.source_view);
  // Twist of the sensor during one turn, in its own frame [m, rad].
  const Isometry3d motion = T_world_target_sensor.inverse() * T_world_source_sensor;
  const Vector6d sweep_motion = options.sweep_motion * logSE3(motion.matrix());
  const auto scanFrom = [&](const Isometry3d& T_world_sensor,
                            std::uint32_t scan_number,
                            const std::string& name) {
    Scan scan = scanScene(
        scene, options.sensor, T_world_sensor, options.seed, scan_number, sweep_motion);
    if (scan.points.cols() == 0)
      throw std::invalid_argument("the " + name + " view sees nothing of scene '" +
                                  options.scene + "'");
    return scan;
  };
  const Scan target = scanFrom(T_world_target_sensor, 0, "target");
  const Scan source = scanFrom(T_world_source_sensor, 1, "source");

  // The frame of a cloud before the offset is applied.
  const auto frameOf = [&options](const Isometry3d& T_world_sensor) {
    return options.frame == CloudFrame::Sensor ? T_world_sensor
                                               : Isometry3d::Identity();
  };
  const Isometry3d T_offset(matrixOf(options.offset));
  const Isometry3d T_target_world = frameOf(T_world_target_sensor).inverse();
  const Isometry3d T_source_world =
      (frameOf(T_world_source_sensor) * T_offset).inverse();
  const Isometry3d T_target_sensor = T_target_world * T_world_target_sensor;
  const Isometry3d T_source_sensor = T_source_world * T_world_source_sensor;

  ScanPair pair;
  pair.target = (T_target_sensor * target.points).cast<float>();
  pair.source = (T_source_sensor * source.points).cast<float>();
  pair.T_target_source = (T_target_world * T_source_world.inverse()).matrix();
  pair.T_source_world = T_source_world.matrix();
  pair.T_target_world = T_target_world.matrix();
  return pair;
}

} // namespace bayesian_icp::simulator
