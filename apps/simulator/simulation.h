/** \file
 * \brief A pair of scans of one scene with the transform between them.
 */
#pragma once

#include "simulator/sensors.h"

#include <bayesian_icp/pose.h>

#include <Eigen/Geometry>

#include <cstdint>
#include <string>

namespace bayesian_icp::simulator {

/** \brief Where a sensor stands and where it looks, world frame [m]. */
struct View {
  Eigen::Vector3d eye;
  Eigen::Vector3d look_at;
};

/** \brief The frame in which clouds are written. */
enum class CloudFrame {
  /** The world frame of the scene, as if the pose of the sensor were known. */
  Object,
  /** The frame of the sensor. */
  Sensor
};

struct SimulationOptions {
  std::string scene;
  SensorOptions sensor;
  View target_view;
  View source_view;
  CloudFrame frame = CloudFrame::Object;
  /** The source is moved by the inverse of this pose (x, y, z, roll, pitch, yaw) [m,
   * rad] before it is written, so with CloudFrame::Object it is the true
   * source-to-target pose. */
  Vector6d offset = Vector6d::Zero();
  /** What part of the motion from the target's to the source's view a LiDAR makes while
   * it turns once, at constant velocity: 1 if the two scans follow each other at once.
   * The true transform is between its poses in the middle of both turns. */
  double sweep_motion = 0.0;
  std::uint64_t seed = 1;
};

/** \brief The usual sensor, views, frame and offset for a scene.
 * \throws std::invalid_argument if there is no scene of this name */
SimulationOptions
defaultOptions(const std::string& scene);

/** \brief Check every option.
 * \throws std::invalid_argument naming the option, the value and what is allowed */
void
validate(const SimulationOptions& options);

/** \brief Pose of a sensor that looks along a view: a camera with its z axis, upright;
 * a LiDAR with its x axis, its z axis as far up as that allows. */
Eigen::Isometry3d
sensorPose(SensorKind kind, const View& view);

struct ScanPair {
  /** 3 x n, each in its own frame [m]. */
  Eigen::Matrix3Xf source;
  Eigen::Matrix3Xf target;
  /** Maps source points into the target frame; exact. */
  Eigen::Matrix4d T_target_source;
  /** Maps world points into the frame of each cloud. */
  Eigen::Matrix4d T_source_world;
  Eigen::Matrix4d T_target_world;
};

/** \brief Scan source and target. The same options give the same bits.
 * \throws std::invalid_argument if the options are bad or a view sees nothing */
ScanPair
simulate(const SimulationOptions& options);

} // namespace bayesian_icp::simulator
