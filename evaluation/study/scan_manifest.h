/** \file
 * \brief The list of pairs in a folder of real scans, manifest.json.
 */
#pragma once

#include <Eigen/Geometry>

#include <optional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

constexpr char manifest_name[] = "manifest.json";

/** \brief Standard deviations of each axis [m, rad]. */
struct AxisDeviation {
  double translation = 0.0;
  double rotation = 0.0;
};

/** \brief A pair of scans. Names of files are relative to the folder. */
struct ManifestEntry {
  std::string name, source, target, ground_truth;
  /** Empty: none is given. */
  std::string initial_guess;
  /** What the pose may be believed to be before registration, about the guess. */
  std::optional<AxisDeviation> prior_sd;
  /** Accuracy of the ground truth. */
  AxisDeviation truth_sd;
};

/** \brief Whether there is FOLDER/manifest.json. */
bool
hasManifest(const std::string& folder);

/** \brief Read FOLDER/manifest.json.
 * \throws io::FileError */
std::vector<ManifestEntry>
readManifest(const std::string& folder);

/** \brief Read a 4 x 4 matrix in text, row by row.
 * \throws io::FileError if there is none, or if it is not a rigid motion */
Eigen::Isometry3d
readTransform(const std::string& file);

} // namespace bayesian_icp::evaluate
