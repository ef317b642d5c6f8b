/** \file
 * \brief Real pairs of scans as cases of the coverage study.
 */
#pragma once

#include "study/coverage_case.h"
#include "study/scan_pairs.h"

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief The pairs of a folder; a pair is read when it is first needed. */
class RealPairs {
public:
  /** \brief Read FOLDER/manifest.json, which has a prior of each pair.
   * \throws io::FileError */
  explicit RealPairs(const std::string& folder);

  /** \brief In the order of the manifest. */
  std::vector<std::string>
  names() const;

  /** \brief A case whose source is a random part of the pair's, 2000 points at most,
   * displaced by a pose drawn from the prior. May be called by several threads.
   * \throws io::FileError if the pair's files cannot be read */
  CoverageCase
  makeCase(const std::string& name, std::uint64_t seed) const;

private:
  std::shared_ptr<const ScanPair>
  pairOf(const ManifestEntry& entry) const;

  std::string folder_;
  std::vector<ManifestEntry> entries_;
  mutable std::mutex mutex_;
  mutable std::map<std::string, std::shared_ptr<const ScanPair>> pairs_;
};

} // namespace bayesian_icp::evaluate
