/** \file
 * \brief Recordings: consecutive scans of one sensor on its way, with the poses at
 * which they were taken.
 */
#pragma once

#include "study/axis_deviation.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief A real or simulated recording. */
struct Recording {
  std::string name;
  /** Of the poses: "exact" of simulated ones, A (known exactly), B (independent), C
   * (found from the scans). */
  std::string quality;
  /** Accuracy of the pose of a scan relative to its neighbour. */
  AxisDeviation truth_sd;
  /** Mean displacement of a scan's points beyond which its pose is lost [m]; NaN of
   * simulated ones. */
  double lost_displacement = std::numeric_limits<double>::quiet_NaN();
  /** T_world_sensor of each scan. */
  std::vector<Eigen::Isometry3d> poses;
  /** The points of a scan in the sensor's frame, 3 x n, finite [m]; may be called by
   * several threads. */
  std::function<Eigen::Matrix3Xd(std::size_t scan)> read;

  /** \brief Where the scan \p source is in the frame of \p target. */
  Eigen::Isometry3d
  relativePose(std::size_t target, std::size_t source) const
  {
    return poses.at(target).inverse() * poses.at(source);
  }
};

/** \brief Every folder in \p folder that has a set.json, by name, with its poses.txt.
 * Scans without a set.json are left out, with a note to the standard error.
 * \throws io::FileError if there is none, or what is wrong with a file */
std::vector<Recording>
readRecordings(const std::string& folder);

/** \brief A guess and the truth of a pair of scans, T_target_source. */
struct PairPoses {
  Eigen::Isometry3d guess;
  Eigen::Isometry3d truth;
};

/** \brief Read a file with one JSON object per line: "set", the name of a sequence,
 * "pair", the number of the target's scan, "guess" and "truth", 3 x 4 matrices. Other
 * keys are ignored.
 * \param[in] file to read
 * \param[in] take gets each line's; a std::exception of it is an error of the line
 * \throws io::FileError with the number of the line that is wrong */
void
readPairPoses(
    const std::string& file,
    const std::function<void(
        const std::string& set, std::uint64_t pair, const PairPoses& poses)>& take);

} // namespace bayesian_icp::evaluate
