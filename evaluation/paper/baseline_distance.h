/** \file
 * \brief How far the draws of a method are from the baseline and from the truth.
 */
#pragma once

#include "paper/paper_baseline.h"
#include "paper/paper_runs.h"

namespace bayesian_icp::evaluate {

/** \brief Distance of a run's draws to the baseline and to the truth.
 * \param[in] name goes into the result */
DistributionRun
distributionRunOf(const PaperRunName& name,
                  const ScanPair& pair,
                  const SamplerRun& run,
                  const PaperBaseline& baseline);

/** \brief Draws of every chain: from row \p first on, \p count of them, both as totals
 * over all chains. */
struct DrawPart {
  int first = 0;
  int count = 0;
};

/** \brief Rows of the chains that did not diverge; what they do not have is left out.
 */
PoseMatrix
partOf(const ChainSet& chains, const DrawPart& part);

/** \brief KL(baseline || draws); infinite with fewer than 10 draws. */
CurveDivergences
curveDivergences(const PoseMatrix& draws, const PaperBaseline& baseline);

} // namespace bayesian_icp::evaluate
