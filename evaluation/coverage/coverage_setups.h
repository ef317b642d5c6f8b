/** \file
 * \brief The scenes of the coverage study: sensor, view and prior of each.
 */
#pragma once

#include "simulator/simulation.h"

#include <bayesian_icp/pose.h>
#include <bayesian_icp/random.h>

#include <Eigen/Core>

#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief How a scene of the study is seen. */
struct CoverageSetup {
  /** The simulator's name of the scene. */
  std::string simulated_scene;
  simulator::SensorOptions sensor;
  simulator::View view;
  /** How far the sensor moves on to a second view [m]; zero: it goes around the point
   * that it looks at. */
  Eigen::Vector3d step = Eigen::Vector3d::Zero();
  /** Standard deviations (x, y, z, roll, pitch, yaw) [m, rad]. */
  Vector6d prior_sd;
};

/** \brief Scenes on which the method's constants were chosen. */
std::vector<std::string>
tunedScenes();

/** \brief Scenes that had no part in the choice of any constant. */
std::vector<std::string>
newScenes();

/** \brief Scenes to drive through with a LiDAR on the roof; no constant was chosen on
 * them. */
inline const std::vector<std::string> lidar_scenes = {
    "street", "office_floor", "forest", "bare_ground", "tunnel"};

/** \brief Sensor, view and prior of a scene. Things of the size of a hand or a table,
 * the corridor and the stairs have the prior of 0.03 m and 0.06 rad (one standard
 * deviation); places seen by a LiDAR, whose points are up to 10 m from their centroid,
 * of 0.1 m and 0.03 rad; lidar_scenes of 0.3 m and 0.03 rad. The sensor of these is
 * carLidar(16), and the view where the drive begins.
 * \throws std::invalid_argument if the study has no scene of this name */
CoverageSetup
coverageSetup(const std::string& scene);

/** \brief A second view: 10 to 20 degrees around the object to a side chosen at random
 * and up to 0.08 m up or down, or CoverageSetup::step on and turned by 0.2 rad.
 * \param[in] scale factor on all of that */
simulator::View
secondView(const CoverageSetup& setup, double scale, Random& random);

/** \brief Both views of a drive. */
struct DrivenViews {
  simulator::View target;
  simulator::View source;
};

/** \brief A drive in one of lidar_scenes: the target is seen up to 8 m before or
 * behind CoverageSetup::view and from a heading up to 0.05 rad beside it; then the
 * sensor goes on by 0.5 to 2 m along an arc that turns by up to 0.07 rad to either
 * side. All uniform, on level ground. */
DrivenViews
drivenViews(const CoverageSetup& setup, Random& random);

} // namespace bayesian_icp::evaluate
