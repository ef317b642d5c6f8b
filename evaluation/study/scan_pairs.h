/** \file
 * \brief Folders of pairs of scans, and the pairs on which the paper's experiments are
 * made.
 */
#pragma once

#include "study/axis_deviation.h"

#include <Eigen/Geometry>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

constexpr char manifest_name[] = "manifest.json";

/** \brief A pair as manifest.json, a list of pairs, has it. Names of files are relative
 * to the folder. */
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

/** \brief Two scans and the true motion between them. The identity is the initial
 * guess, and the origin is on the object, so that a rotation about it does not carry
 * the object away: what the paper's priors and starts, which are about zero, need. */
struct ScanPair {
  std::string name;
  /** 3 x n, finite [m]. */
  Eigen::Matrix3Xd source;
  Eigen::Matrix3Xd target;
  /** T_target_source, and how accurately it is known (simulated: exactly). */
  Eigen::Isometry3d truth = Eigen::Isometry3d::Identity();
  AxisDeviation truth_sd;

  /** \brief A number that tells one pair's clouds and truth from another's. */
  std::uint64_t
  key() const;
};

/** \brief The paper's six objects as they are named in data/, in the order of its
 * Table I. */
inline const std::vector<std::string> paper_objects = {
    "bowl", "can", "mug_hidden_handle", "table_top", "mug", "table"};

/** \brief Names of the pairs in a folder: those of its manifest.json, or the paper's
 * six objects if it has none.
 * \throws io::FileError */
std::vector<std::string>
pairNames(const std::string& folder);

/** \brief Read a pair. In a folder without a manifest it is NAME/source.pcd, target.pcd
 * and T_target_source.txt, and the frames are those of the files. In a folder with one
 * the source is moved by the pair's initial guess, and then the centroid of the target
 * is made the origin of both.
 * \throws io::FileError if a file is missing or broken, or the manifest has no such
 *         pair */
ScanPair
readScanPair(const std::string& folder, const std::string& name);

/** \brief Read a pair of a manifest; the frames are those of the files.
 * \throws io::FileError if a file is missing or broken */
ScanPair
readScanPair(const std::string& folder, const ManifestEntry& entry);

/** \brief \p num_points columns of the source chosen at random, always the same ones;
 * all of it if it has no more, or for 0. */
void
thinSource(ScanPair& pair, int num_points);

} // namespace bayesian_icp::evaluate
