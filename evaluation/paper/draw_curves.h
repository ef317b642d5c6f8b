/** \file
 * \brief KL to the baseline as a function of which draws of a run are taken: the
 * paper's curves over the number of draws and over the length of burn-in.
 */
#pragma once

#include "paper/paper_baseline.h"
#include "paper/paper_runs.h"

namespace bayesian_icp::evaluate {

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
