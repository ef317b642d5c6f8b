#include "paper/draw_curves.h"

#include "study/draw_statistics.h"

#include <algorithm>
#include <limits>

namespace bayesian_icp::evaluate {

PoseMatrix
partOf(const ChainSet& chains, const DrawPart& part)
{
  const auto num_chains = static_cast<Eigen::Index>(chains.chains.size());
  const Eigen::Index first = part.first / num_chains, count = part.count / num_chains;
  PoseMatrix rows(0, 6);
  for (const Chain& chain : chains.chains) {
    const Eigen::Index num_rows =
        chain.diverged ? 0
                       : std::clamp<Eigen::Index>(chain.draws.rows() - first, 0, count);
    const Eigen::Index begin = rows.rows();
    rows.conservativeResize(begin + num_rows, 6);
    rows.bottomRows(num_rows) =
        chain.draws.middleRows(num_rows > 0 ? first : 0, num_rows);
  }
  return rows;
}

CurveDivergences
curveDivergences(const PoseMatrix& draws, const PaperBaseline& baseline)
{
  CurveDivergences divergences;
  divergences.setConstant(std::numeric_limits<double>::infinity());
  if (draws.rows() < min_scored_draws)
    return divergences;
  const Moments p = momentsOf(unwrapAbout(baseline.mean, baseline.ends));
  const Moments q = momentsOf(unwrapAbout(baseline.mean, draws));
  for (int k = 0; k < 6; ++k)
    divergences[k] = gaussianKl(p, q, k);
  divergences[6] = gaussianKl(p, q);
  return divergences;
}

} // namespace bayesian_icp::evaluate
