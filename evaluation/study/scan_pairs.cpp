#include "study/scan_pairs.h"

#include "io/cloud_file.h"
#include "io/errors.h"
#include "study/input_hash.h"

#include <bayesian_icp/random.h>

#include <algorithm>

namespace bayesian_icp::evaluate {

using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

namespace {

constexpr std::uint64_t thinning_stream = 0x7061697273;

/** Make \p guess the identity and the target's centroid the origin. */
void
centre(ScanPair& pair, const Isometry3d& guess)
{
  const Vector3d origin = pair.target.rowwise().mean();
  pair.target.colwise() -= origin;
  pair.source = guess * pair.source;
  pair.source.colwise() -= origin;
  pair.truth =
      Translation3d(-origin) * pair.truth * guess.inverse() * Translation3d(origin);
}

} // namespace

std::uint64_t
ScanPair::key() const
{
  InputHash hash;
  hash.addMatrix(source);
  hash.addMatrix(target);
  hash.addMatrix(truth.matrix());
  return hash.value();
}

const std::vector<std::string>&
paperObjects()
{
  static const std::vector<std::string> objects = {
      "bowl", "can", "mug_hidden_handle", "table_top", "mug", "table"};
  return objects;
}

std::vector<std::string>
pairNames(const std::string& folder)
{
  if (!hasManifest(folder))
    return paperObjects();
  std::vector<std::string> names;
  for (const ManifestEntry& entry : readManifest(folder))
    names.push_back(entry.name);
  return names;
}

ScanPair
readScanPair(const std::string& folder, const ManifestEntry& entry)
{
  ScanPair pair;
  pair.name = entry.name;
  pair.source = io::readFinitePoints(folder + "/" + entry.source).cast<double>();
  pair.target = io::readFinitePoints(folder + "/" + entry.target).cast<double>();
  pair.truth = readTransform(folder + "/" + entry.ground_truth);
  pair.truth_sd = entry.truth_sd;
  return pair;
}

ScanPair
readScanPair(const std::string& folder, const std::string& name)
{
  if (!hasManifest(folder)) {
    ManifestEntry entry;
    entry.name = name;
    entry.source = name + "/source.pcd";
    entry.target = name + "/target.pcd";
    entry.ground_truth = name + "/T_target_source.txt";
    return readScanPair(folder, entry);
  }
  for (const ManifestEntry& entry : readManifest(folder))
    if (entry.name == name) {
      ScanPair pair = readScanPair(folder, entry);
      centre(pair,
             entry.initial_guess.empty()
                 ? Isometry3d::Identity()
                 : readTransform(folder + "/" + entry.initial_guess));
      return pair;
    }
  throw io::FileError(folder + "/" + manifest_name,
                      "has no pair " + io::inQuotes(name));
}

void
thinSource(ScanPair& pair, int num_points)
{
  if (num_points == 0 || pair.source.cols() <= num_points)
    return;
  Random random(1, thinning_stream);
  const Eigen::Matrix3Xd chosen =
      pair.source(Eigen::all, randomChoice(pair.source.cols(), num_points, random));
  pair.source = chosen;
}

} // namespace bayesian_icp::evaluate
