#include "study/scan_pairs.h"

#include "io/cloud_file.h"
#include "io/errors.h"
#include "io/json_file.h"
#include "io/motion.h"
#include "study/input_hash.h"
#include "study/named.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <stdexcept>

namespace bayesian_icp::evaluate {

using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

namespace {

constexpr std::uint64_t max_manifest_size = 16 << 20;
constexpr double radians_per_degree = 3.14159265358979323846 / 180.0;

/** \throws std::exception */
ManifestEntry
entryOf(const nlohmann::json& json)
{
  ManifestEntry entry;
  const auto& files = json.at("files");
  entry.name = json.at("name");
  entry.source = files.at("source");
  entry.target = files.at("target");
  entry.ground_truth = files.at("ground_truth");
  entry.initial_guess = files.value("initial_guess", "");
  if (const auto prior = json.find("suggested_prior_sigma"); prior != json.end())
    entry.prior_sd = {prior->at("translation_m"), prior->at("rotation_rad")};
  const AxisDeviation sd = entry.prior_sd.value_or(AxisDeviation{1.0, 1.0});
  if (!(sd.translation > 0.0 && sd.rotation > 0.0))
    throw std::runtime_error("suggested_prior_sigma of " + io::inQuotes(entry.name) +
                             " must be positive");
  const auto& accuracy = json.at("ground_truth_accuracy");
  // The manifest's are of the whole vector.
  entry.truth_sd.translation =
      accuracy.at("translation_m").get<double>() / std::sqrt(3.0);
  entry.truth_sd.rotation =
      accuracy.at("rotation_deg").get<double>() * radians_per_degree / std::sqrt(3.0);
  return entry;
}

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

bool
hasManifest(const std::string& folder)
{
  return std::filesystem::exists(folder + "/" + manifest_name);
}

std::vector<ManifestEntry>
readManifest(const std::string& folder)
{
  const std::string file = folder + "/" + manifest_name;
  const nlohmann::json manifest = io::readJson(file, max_manifest_size);
  std::vector<ManifestEntry> entries;
  try {
    for (const auto& json : manifest) {
      const ManifestEntry entry = entryOf(json);
      // Files of results have the name in theirs.
      if (entry.name.empty() || entry.name.find('/') != std::string::npos)
        throw std::runtime_error("the name " + io::inQuotes(entry.name) +
                                 " is empty or has a slash");
      if (findNamed(entries, entry.name) != nullptr)
        throw std::runtime_error("has two pairs " + io::inQuotes(entry.name));
      entries.push_back(entry);
    }
  }
  catch (const std::exception& error) {
    throw io::FileError(file, error.what());
  }
  return entries;
}

std::uint64_t
ScanPair::key() const
{
  InputHash hash;
  hash.addMatrix(source);
  hash.addMatrix(target);
  hash.addMatrix(truth.matrix());
  return hash.value();
}

std::vector<std::string>
pairNames(const std::string& folder)
{
  return hasManifest(folder) ? namesOf(readManifest(folder)) : paper_objects;
}

ScanPair
readScanPair(const std::string& folder, const ManifestEntry& entry)
{
  ScanPair pair;
  pair.name = entry.name;
  pair.source = io::readFinitePoints(folder + "/" + entry.source).cast<double>();
  pair.target = io::readFinitePoints(folder + "/" + entry.target).cast<double>();
  pair.truth = Isometry3d(io::readMatrixFile(folder + "/" + entry.ground_truth));
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
  const std::vector<ManifestEntry> manifest = readManifest(folder);
  const ManifestEntry* const entry = findNamed(manifest, name);
  if (entry == nullptr)
    throw io::FileError(folder + "/" + manifest_name,
                        "has no pair " + io::inQuotes(name));
  ScanPair pair = readScanPair(folder, *entry);
  const std::string& guess = entry->initial_guess;
  centre(pair,
         guess.empty() ? Isometry3d::Identity()
                       : Isometry3d(io::readMatrixFile(folder + "/" + guess)));
  return pair;
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
