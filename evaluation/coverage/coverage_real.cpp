#include "coverage/coverage_real.h"

#include "geometry/twist.h"
#include "io/errors.h"
#include "io/text_hash.h"
#include "methods/baseline_problem.h"

#include <bayesian_icp/random.h>

namespace bayesian_icp::evaluate {

RealPairs::RealPairs(const std::string& folder)
: folder_(folder)
, entries_(readManifest(folder))
{
  for (const ManifestEntry& entry : entries_)
    if (!entry.prior_sd)
      throw io::FileError(folder_ + "/" + manifest_name,
                          "has no suggested_prior_sigma of " +
                              io::inQuotes(entry.name));
}

std::vector<std::string>
RealPairs::names() const
{
  std::vector<std::string> names;
  for (const ManifestEntry& entry : entries_)
    names.push_back(entry.name);
  return names;
}

const ManifestEntry&
RealPairs::entryOf(const std::string& name) const
{
  for (const ManifestEntry& entry : entries_)
    if (entry.name == name)
      return entry;
  throw io::FileError(folder_, "has no pair " + io::inQuotes(name));
}

std::shared_ptr<const ScanPair>
RealPairs::pairOf(const ManifestEntry& entry) const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  auto& pair = pairs_[entry.name];
  if (!pair)
    pair = std::make_shared<const ScanPair>(readScanPair(folder_, entry));
  return pair;
}

CoverageCase
RealPairs::makeCase(const std::string& name, std::uint64_t seed) const
{
  const ManifestEntry& entry = entryOf(name);
  const auto pair = pairOf(entry);
  // Cases of one seed share no random numbers.
  Random random(seed, io::hashOf(name));
  CoverageCase made;
  made.scene = name;
  made.condition = "real";
  made.seed = seed;
  made.target = pair->target;
  made.prior_sd << Eigen::Vector3d::Constant(entry.prior_sd->translation),
      Eigen::Vector3d::Constant(entry.prior_sd->rotation);
  made.truth_sd_translation = entry.truth_sd.translation;
  made.truth_sd_rotation = entry.truth_sd.rotation;
  const auto part = randomChoice(pair->source.cols(), max_source_points, random);
  made.source = pair->truth * pair->source(Eigen::all, part);
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
