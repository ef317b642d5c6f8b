/** \file
 * \brief Further modes of the calibrated posterior, where the prior is wide.
 */
#pragma once

#include "calibrated/draws/calibrated_draws.h"

#include <cstdint>
#include <vector>

namespace bayesian_icp {

/** \brief How hard to look for modes. */
struct ModeSearchOptions {
  /** Starts, spread evenly over the wide coordinates of the prior. */
  int num_starts = 16;
  /** Source points on which starts are followed. */
  int num_points = 300;
  int max_modes = 8;
  std::uint64_t seed = 1;
  /** For each mode that is found. */
  EstimateOptions estimate;
};

/** \brief Modes, and what they cost. */
struct ModeSearch {
  /** At least one; heaviest first. Weights count differences in fit only as far as they
   * are above their own noise. */
  std::vector<CalibratedMode> modes;
  /** Nearest-neighbour queries beyond those of the first estimate. */
  long num_queries = 0;
};

/** \brief Whether the prior is so wide that there may be other modes: a standard
 * deviation above 0.2 rad, or above a quarter of the diagonal of the source's bounding
 * box. */
bool
mayHaveSeveralModes(const SurfaceScorer& scorer, const Prior& prior);

/** \brief Look for modes other than \p first. A motion held by the prior only makes no
 * mode of its own. Not more than about 150 000 queries to look, and those of one
 * estimate for each mode. */
ModeSearch
findModes(const SurfaceScorer& scorer,
          const Prior& prior,
          const CalibratedEstimate& first,
          const ModeSearchOptions& options = ModeSearchOptions());

/** \brief Of modes, heaviest first, those that hold at least two per cent of the
 * posterior. A weight is good to a factor of a few, so that lighter ones are not told
 * from none. */
std::vector<CalibratedMode>
significantModes(std::vector<CalibratedMode> modes);

/** \brief The estimate, and where the prior is wide the other significantModes();
 * heaviest first. */
std::vector<CalibratedMode>
calibratedModes(const SurfaceScorer& scorer,
                const Prior& prior,
                const ModeSearchOptions& options = ModeSearchOptions());

} // namespace bayesian_icp
