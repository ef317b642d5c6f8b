#include "coverage_real.h"

#include "scene.h"

#include <bayesian_icp/calibration/twist.h>

#include <io/errors.h>
#include <io/text_hash.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>

namespace bayesian_icp::evaluate {

namespace {

constexpr Eigen::Index max_source_points = 2000;
constexpr double radians_per_degree = 3.14159265358979323846 / 180.0;

Eigen::Isometry3d
readTransform(const std::string& file)
{
  std::ifstream stream(file);
  Eigen::Isometry3d transform;
  for (Eigen::Index i = 0; i < 16; ++i)
    if (!(stream >> transform.matrix()(i / 4, i % 4)))
      throw io::FileError(file, "is not a 4 x 4 matrix");
  if (!transform.linear().isUnitary(1e-3))
    throw io::FileError(file, "is not a rigid motion");
  return transform;
}

} // namespace

RealPairs::RealPairs(const std::string& folder) : folder_(folder + "/")
{
  const std::string file = folder_ + "manifest.json";
  std::ifstream stream(file);
  if (!stream)
    throw io::FileError(file, "cannot be read");
  try {
    for (const auto& json : nlohmann::json::parse(stream)) {
      Entry entry;
      entry.name = json.at("name");
      entry.source = json.at("files").at("source");
      entry.target = json.at("files").at("target");
      entry.ground_truth = json.at("files").at("ground_truth");
      const auto& prior = json.at("suggested_prior_sigma");
      entry.scale.prior_sd_translation = prior.at("translation_m");
      entry.scale.prior_sd_rotation = prior.at("rotation_rad");
      const auto& accuracy = json.at("ground_truth_accuracy");
      // The manifest's are of the whole vector.
      entry.scale.truth_sd_translation =
          accuracy.at("translation_m").get<double>() / std::sqrt(3.0);
      entry.scale.truth_sd_rotation = accuracy.at("rotation_deg").get<double>() *
                                      radians_per_degree / std::sqrt(3.0);
      entries_.push_back(std::move(entry));
    }
  }
  catch (const nlohmann::json::exception& error) {
    throw io::FileError(file, error.what());
  }
}

std::vector<std::string>
RealPairs::names() const
{
  std::vector<std::string> names;
  for (const Entry& entry : entries_)
    names.push_back(entry.name);
  return names;
}

const RealPairs::Entry&
RealPairs::entryOf(const std::string& name) const
{
  for (const Entry& entry : entries_)
    if (entry.name == name)
      return entry;
  throw io::FileError(folder_, "has no pair " + io::quoted(name));
}

std::shared_ptr<const RealPairs::Clouds>
RealPairs::cloudsOf(const Entry& entry) const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  auto& clouds = clouds_[entry.name];
  if (!clouds) {
    Clouds read;
    const Eigen::Isometry3d T_target_source =
        readTransform(folder_ + entry.ground_truth);
    read.source_in_target =
        T_target_source * finitePoints(folder_ + entry.source).cast<double>();
    read.target = finitePoints(folder_ + entry.target).cast<double>();
    clouds = std::make_shared<const Clouds>(std::move(read));
  }
  return clouds;
}

CoverageCase
RealPairs::makeCase(const std::string& name, std::uint64_t seed) const
{
  const Entry& entry = entryOf(name);
  const auto clouds = cloudsOf(entry);
  const RealScale& scale = entry.scale;
  // Cases of one seed share no random numbers.
  Random random(seed, io::hashOf(name));
  CoverageCase made;
  made.scene = name;
  made.condition = "real";
  made.seed = seed;
  made.target = clouds->target;
  made.prior_sd << Eigen::Vector3d::Constant(scale.prior_sd_translation),
      Eigen::Vector3d::Constant(scale.prior_sd_rotation);
  made.truth_sd_translation = scale.truth_sd_translation;
  made.truth_sd_rotation = scale.truth_sd_rotation;
  const Eigen::Matrix3Xd& all = clouds->source_in_target;
  const auto part = randomChoice(all.cols(), max_source_points, random);
  made.source = all(Eigen::all, part);
  // The prior is about no motion: the truth turns the source about its centroid, and
  // shifts the centroid by the first three numbers.
  const Vector6d deviation = made.prior_sd.cwiseProduct(random.normal6());
  const Eigen::Vector3d moved_centroid = made.source.rowwise().mean();
  const Eigen::Vector3d centroid = moved_centroid - deviation.head<3>();
  made.truth.linear() = rotationOf(deviation);
  made.truth.translation() = moved_centroid - made.truth.linear() * centroid;
  made.source = made.truth.inverse() * made.source;
  return made;
}

} // namespace bayesian_icp::evaluate
