/** \file
 * \brief Runs of simulation-based calibration that are not in their file yet, on all
 * cores.
 */
#pragma once

#include "row_file.h"
#include "sbc/rank_samplers.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief The CSV file: a row a run, in the order in which they ended. Not for several
 * threads at once. */
class RankFile {
public:
  /** \brief Read what is there; see RowFile. */
  explicit RankFile(const std::string& name);

  bool
  has(const std::string& sampler, std::uint64_t seed) const;

  /** \brief Write a row, at once; no ranks: the draws were no good.
   * \throws io::FileError */
  void
  add(const std::string& sampler,
      std::uint64_t seed,
      const std::optional<Ranks>& ranks);

  /** \brief Ranks of a run; nothing if it is not there or its draws were no good. */
  std::optional<Ranks>
  find(const std::string& sampler, std::uint64_t seed) const;

private:
  std::map<std::pair<std::string, std::uint64_t>, std::optional<Ranks>> runs_;
  RowFile file_;
};

/** \brief What is run. */
struct RankStudy {
  std::vector<RankSampler> samplers;
  int num_runs = 500;
  std::uint64_t first_seed = 1;
  int num_threads = 1;
  /** Told after each run, by one thread at a time. */
  std::function<void(std::size_t num_done, std::size_t num_all)> report;
};

/** \brief Run what \p results does not have. A row does not depend on the number of
 * threads.
 * \throws io::FileError, and what samplers throw; rows of other runs are kept */
void
runRankStudy(const RankStudy& study, RankFile& results);

/** \brief The ranks of one sampler's good runs. */
std::vector<Ranks>
ranksOfSampler(const RankStudy& study,
               const RankSampler& sampler,
               const RankFile& results);

} // namespace bayesian_icp::evaluate
