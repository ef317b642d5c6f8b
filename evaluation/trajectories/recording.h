/** \file
 * \brief Scans of one sensor on its way, with the poses at which they were taken.
 */
#pragma once

#include "study/scan_manifest.h"

#include <Eigen/Geometry>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief A real or simulated sequence of scans, each in the sensor's frame [m]. */
struct Recording {
  std::string name;
  /** Of the poses: "exact" of simulated ones, A, B or C as in ScanSequence. */
  std::string quality;
  /** T_world_sensor of each scan. */
  std::vector<Eigen::Isometry3d> poses;
  /** Accuracy of the pose of a scan relative to its neighbour. */
  AxisDeviation truth_sd;
  /** The points of a scan, 3 x n, finite [m]; may be called by several threads. */
  std::function<Eigen::Matrix3Xd(std::size_t scan)> read;

  /** \brief Where the scan \p source is in the frame of \p target. */
  Eigen::Isometry3d
  relativePose(std::size_t target, std::size_t source) const
  {
    return poses.at(target).inverse() * poses.at(source);
  }
};

/** \brief Names of the simulated drives: a car with a spinning LiDAR of 32 rings in a
 * street; a robot with one of 16 rings around a block of corridors, and to and fro on a
 * floor of offices; a depth camera that is carried around in a room. All but the street
 * come back to where they have been. */
std::vector<std::string>
driveNames();

/** \brief A simulated drive. Scans are of one instant each, ten per second.
 * \param[in] seed of the noise
 * \param[in] num_scans on the whole way, at least 2
 * \throws std::invalid_argument if there is no drive of this name */
Recording
makeDrive(const std::string& name, std::uint64_t seed, std::size_t num_scans);

/** \brief The recordings in a folder of sequences, see readSequences().
 * \param[in] folder that has them
 * \param[in] max_scans of each recording, the first ones
 * \throws io::FileError what is wrong with a file, or if a recording has one scan only
 */
std::vector<Recording>
readRecordings(const std::string& folder, std::size_t max_scans);

} // namespace bayesian_icp::evaluate
