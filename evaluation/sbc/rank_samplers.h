/** \file
 * \brief The samplers whose ranks are looked at.
 */
#pragma once

#include "sbc/rank_statistics.h"
#include "study/text_table.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief A sampler and the model that it is given. */
struct RankSampler {
  std::string name;
  /** Whether the data are drawn from the very likelihood, so that ranks have to be
   * uniform. */
  bool is_well_specified;
  /** One run: true pose, data, draws, ranks; nothing if the draws are no good. Uses one
   * thread, is called by several at once, and depends on the seed only. */
  std::function<std::optional<Ranks>(std::uint64_t seed)> run;
};

/** \brief All of them:
 *
 * - exact-langevin, exact-metropolis: preset `exact` on FarPointsModel.
 * - calibrated: sampleCalibrated() on LinearScoreModel, with a free yaw in every other
 *   run.
 * - calibrated-scans: preset `calibrated` on simulated scans of the tuned scenes, same
 *   view; not a well-specified model. */
std::vector<RankSampler>
rankSamplers();

/** \brief What the ranks of some runs say. */
struct RankVerdict {
  /** A line for each sampler: runs, chi-square statistic of each coordinate, verdict.
   */
  TextTable table;
  /** Whether every well-specified sampler has uniform ranks: all runs good and, of at
   * least min_ranked_runs, every statistic below max_rank_chi_square. */
  bool are_uniform = true;
};

RankVerdict
verdictOf(const std::vector<RankRun>& runs);

} // namespace bayesian_icp::evaluate
