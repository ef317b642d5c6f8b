/** \file
 * \brief A scan of a scene: what one look of a depth camera or a LiDAR gives.
 *
 * Sensor frames: a camera looks along its z axis, x to the right and y down; a LiDAR
 * spins about its z axis, azimuth 0 is its x axis.
 */
#pragma once

#include "simulator/scenes.h"
#include "simulator/sensor_options.h"

#include <bayesian_icp/pose.h>

#include <Eigen/Geometry>

#include <cstdint>
#include <vector>

namespace bayesian_icp::simulator {

struct Scan {
  /** 3 x n, sensor frame [m]. */
  Eigen::Matrix3Xd points;
  /** The ray of each point: row * raysPerRow() + column, where a row is an image row, 0
   * the highest, or a ring, 0 the lowest. Ascending. */
  std::vector<std::uint32_t> ray_indices;
};

/** \brief Scan a scene. The result depends on the arguments only, not on the number of
 * threads.
 * \param[in] T_world_sensor pose of the sensor
 * \param[in] seed,scan_number determine the noise: another scan number, other noise
 * \param[in] sweep_motion twist (v, w) in the sensor frame [m, rad]: how far the sensor
 *            moves while a LiDAR turns once, at constant velocity. It starts to turn at
 *            the back and is at \p T_world_sensor when it looks along its x axis.
 * Points are in the frame of the sensor at their own time; nothing corrects them.
 * \throws std::invalid_argument if validate() refuses the options */
Scan
scanScene(const Scene& scene,
          const SensorOptions& options,
          const Eigen::Isometry3d& T_world_sensor,
          std::uint64_t seed,
          std::uint32_t scan_number,
          const Vector6d& sweep_motion = Vector6d::Zero());

} // namespace bayesian_icp::simulator
