/** \file
 * \brief What pcl_bayesian_icp_track is asked for.
 */
#pragma once

#include "register/settings.h"

#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief Everything that decides the result of a track. */
struct TrackRequest {
  /** Files of the scans, in their order. */
  std::vector<std::string> scans;
  /** When each was taken [s]; increasing. */
  std::vector<double> times;
  /** Guess and prior are those of the motion from scan 0 to scan 1. */
  Settings settings;
  /** Standard deviations of the motion model [m/s^2, rad/s^2]. */
  double acceleration = 5.0;
  double angular_acceleration = 5.0;
  /** Each scan is registered to so many scans before it; the filter takes the edge to
   * its target only. */
  int span = 1;
  /** Width of the voxels that keep one point of a map [m]; 0: the target is one scan.
   */
  double voxel_size = 0.0;
  /** Scans that make a map. */
  int map_scans = 5;
};

} // namespace bayesian_icp::app
