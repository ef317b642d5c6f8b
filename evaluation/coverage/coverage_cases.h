/** \file
 * \brief The cases of the coverage study: every scene, with its sensor, view and prior,
 * under every condition, as often as there are seeds.
 */
#pragma once

#include "simulator/simulation.h"
#include "study/coverage_case.h"

#include <cstdint>
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
    "street", "office_floor", "forest", "bare_ground", "tunnel", "tunnel_cabinets"};

/** \brief Sensor, view and prior of a scene. Things of the size of a hand or a table,
 * the corridor and the stairs have the prior of 0.03 m and 0.06 rad (one standard
 * deviation); places seen by a LiDAR, whose points are up to 10 m from their centroid,
 * of 0.1 m and 0.03 rad; lidar_scenes of 0.3 m and 0.03 rad. The sensor of these is
 * carLidar(16), and the view where the drive begins.
 * \throws std::invalid_argument if the study has no scene of this name */
CoverageSetup
coverageSetup(const std::string& scene);

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

/** \brief What happens to the two scans of a case. Rays are jittered in all of them, so
 * no two scans have the same sampling grid.
 *
 * - same: both from one view, with the sensor's noise.
 * - moved: the source from secondView().
 * - half: the source with half the rows and half the columns.
 * - noise3: three times the noise.
 * - correlated: 70 % of the noise's variance is shared by neighbouring rays, and
 *   readings are quantised, as a Kinect's (camera) or to 10 mm (LiDAR).
 * - outliers: 5 % of the source's readings are off, by 0.1 m (standard deviation).
 * - lost20, lost50: the source from a view moved a quarter as far as in `moved`; then
 *   the target loses all points on one side of a plane, chosen at random but parallel
 *   to the line of sight (camera) or upright (LiDAR), that has 20 or 50 % of the
 *   source's points on that side. */
inline const std::vector<std::string> coverage_conditions = {
    "same", "moved", "half", "noise3", "correlated", "outliers", "lost20", "lost50"};

/** \brief Conditions of the same scenes that a study has only if it is told to.
 *
 * - far: `moved` with a true pose 1 m and 0.8 rad off (standard deviations of each
 * axis) and a prior that says so: most starts end in another basin.
 * - clean_target, exact_target: `moved` with a tenth of the noise in the target, as in
 *   the map of a better scanner, and with none, as in a CAD model.
 * - points_quarter, points_x4, points_x16, points_x64: `same` with that many times the
 *   points in both clouds. */
inline const std::vector<std::string> further_conditions = {"far",
                                                            "clean_target",
                                                            "exact_target",
                                                            "points_quarter",
                                                            "points_x4",
                                                            "points_x16",
                                                            "points_x64"};

/** \brief What lidar_scenes are seen with: carLidar(), whose rings have other offsets
 * in every case, from both of drivenViews(). No ray is jittered.
 *
 * - lidar16, lidar32, lidar64: the number of rings; the sensor stands still in each
 * scan.
 * - lidar64_sweep: the scans are turns that follow each other at once while the sensor
 *   moves at constant velocity. The truth is between the middles of both turns. */
inline const std::vector<std::string> lidar_conditions = {
    "lidar16", "lidar32", "lidar64", "lidar64_sweep"};

/** \brief Conditions of lidar_scenes that a study has only if it is told to.
 *
 * - lidar1: a 2-D laser scanner, one level ring with a ray every 0.25 degrees. */
inline const std::vector<std::string> further_lidar_conditions = {"lidar1"};

/** \brief Simulate a case: a scene of lidar_scenes under one of its conditions, or
 * another one under one of coverage_conditions or further_conditions; all of it
 * depends on the three arguments only. The target frame is the scene's world frame. The
 * true pose is drawn from the prior (angles from a Gaussian), and the source is not
 * thinned. \throws std::invalid_argument if there is no such scene or condition */
CoverageCase
makeCoverageCase(const std::string& scene,
                 const std::string& condition,
                 std::uint64_t seed);

/** \brief Draw the true pose from the case's prior, whose mean is no motion, and move
 * the source, which comes in the target frame, by its inverse. */
void
displaceSource(Random& random, CoverageCase& drawn);

} // namespace bayesian_icp::evaluate
