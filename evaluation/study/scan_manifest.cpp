#include "study/scan_manifest.h"

#include "io/errors.h"
#include "io/json_file.h"
#include "io/motion.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>

namespace bayesian_icp::evaluate {

namespace {

constexpr std::uint64_t max_manifest_size = 16 << 20;
constexpr double radians_per_degree = 3.14159265358979323846 / 180.0;

/** \throws nlohmann::json::exception */
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
  const auto& accuracy = json.at("ground_truth_accuracy");
  // The manifest's are of the whole vector.
  entry.truth_sd.translation =
      accuracy.at("translation_m").get<double>() / std::sqrt(3.0);
  entry.truth_sd.rotation =
      accuracy.at("rotation_deg").get<double>() * radians_per_degree / std::sqrt(3.0);
  return entry;
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
    for (const auto& json : manifest)
      entries.push_back(entryOf(json));
  }
  catch (const nlohmann::json::exception& error) {
    throw io::FileError(file, error.what());
  }
  return entries;
}

Eigen::Isometry3d
readTransform(const std::string& file)
{
  return Eigen::Isometry3d(io::readMatrixFile(file));
}

} // namespace bayesian_icp::evaluate
