/** \file
 * \brief Search for further modes of the calibrated posterior: where the prior is wide,
 * where the first mode fits badly, and on parallel faces.
 */
#pragma once

#include "calibrated/draws/calibrated_draws.h"

#include <cstdint>
#include <vector>

namespace bayesian_icp {

/** \brief Effort of the search for modes. */
struct ModeSearchOptions {
  /** Number of starts, spread evenly over the wide coordinates of the prior. Where a
   * rotation's deviation is above 0.5 rad, hops from the best end follow: slides and
   * half turns. */
  int num_starts = 16;
  /** Number of points of one cloud on which starts are followed. */
  int num_points = 300;
  int max_modes = 8;
  std::uint64_t seed = 1;
  /** Options for the estimate of each mode that is found. */
  EstimateOptions estimate;
};

/** \brief Whether there may be other modes: the prior is wide, or many points do not
 * fit at \p first. A prior is wide if a standard deviation is above 0.2 rad, or above a
 * quarter of the diagonal of the source's bounding box. */
bool
mayHaveSeveralModes(const SurfaceScorer& scorer,
                    const HeldPrior& prior,
                    const CalibratedEstimate& first);

/** \brief Search for modes other than \p first, and drop \p first if another pose fits
 * clearly better. Poses that differ by a motion that only the prior holds are one mode.
 * If mayHaveSeveralModes(), starts are followed, which takes at most about 150 000
 * queries, and twice as many with hops. Hops onto parallel faces are always tried. To
 * look for faces takes some 4000 to 20 000 queries, and to follow hops at most about
 * 200 000. If many points of the source do not fit at \p first, all this is repeated
 * with points of the target, which lead if they fit far better: a scan leads where the
 * source is its model. Each mode that is found takes one estimate.
 * \return at least one mode, heaviest first. A difference in fit counts only as far as
 *         it is above its own noise. */
std::vector<CalibratedMode>
findModes(const SurfaceScorer& scorer,
          const HeldPrior& prior,
          const CalibratedEstimate& first,
          const ModeSearchOptions& options = ModeSearchOptions());

/** \brief The modes that hold at least two per cent of the posterior. Weights are
 * accurate to a factor of a few, so lighter modes cannot be distinguished from none.
 * \param[in] modes heaviest first */
std::vector<CalibratedMode>
significantModes(std::vector<CalibratedMode> modes);

/** \brief The modes but those within the 99 % region of what another one's clouds say:
 * a posterior that is as wide as the distance of two modes holds both, so the wider one
 * alone is reported, even where the other one fits better.
 * \param[in] modes heaviest first; of two that are within each other's, the heavier one
 *            stays */
std::vector<CalibratedMode>
separateModes(std::vector<CalibratedMode> modes);

/** \brief The significantModes() of the search from the first estimate that are
 * separateModes(), heaviest first.
 * In a narrow prior that holds a motion, a better fit outside of it is looked for
 * (CalibratedEstimate::better_fit of the heaviest). */
std::vector<CalibratedMode>
calibratedModes(const SurfaceScorer& scorer,
                const HeldPrior& prior,
                const ModeSearchOptions& options = ModeSearchOptions());

} // namespace bayesian_icp
