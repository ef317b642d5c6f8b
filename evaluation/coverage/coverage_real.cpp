#include "coverage/coverage_real.h"

#include "coverage/coverage_cases.h"
#include "io/errors.h"
#include "io/text_hash.h"
#include "methods/baseline_problem.h"
#include "study/named.h"

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
  return namesOf(entries_);
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
  const ManifestEntry* const entry = findNamed(entries_, name);
  if (entry == nullptr)
    throw io::FileError(folder_, "has no pair " + io::inQuotes(name));
  const auto pair = pairOf(*entry);
  // Cases of one seed share no random numbers.
  Random random(seed, io::hashOf(name));
  CoverageCase made;
  made.scene = name;
  made.condition = "real";
  made.seed = seed;
  made.target = pair->target;
  made.prior_sd = entry->prior_sd->vector();
  made.truth_sd = entry->truth_sd;
  const auto part = randomChoice(pair->source.cols(), max_source_points, random);
  made.source = pair->truth * pair->source(Eigen::all, part);
  displaceSource(random, made);
  return made;
}

} // namespace bayesian_icp::evaluate
