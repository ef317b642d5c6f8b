#include "coverage_calibrated.h"

#include "coverage_methods.h"
#include "random_part.h"

#include <bayesian_icp/calibration/calibrated_modes.h>

#include <Eigen/Cholesky>

#include <cmath>

namespace bayesian_icp::evaluate {

namespace {

constexpr Eigen::Index max_source_points = 2000;
constexpr std::uint64_t thinning_stream = 0x7468696e;

/** All points, or max_source_points of them at random. */
Eigen::Matrix3Xd
thinnedSource(const CoverageCase& problem)
{
  if (problem.source.cols() <= max_source_points)
    return problem.source;
  Random random(problem.seed, thinning_stream);
  return problem.source(Eigen::all,
                        randomPart(problem.source.cols(), max_source_points, random));
}

/** The flags of DataReport, and how many directions the data say nothing about. */
std::string
notesOf(const CalibratedEstimate& estimate, Eigen::Index num_points)
{
  std::string notes;
  const auto flag = [&notes](bool is_raised, const char* name) {
    if (is_raised)
      notes += std::string("flag:") + name + ';';
  };
  const double basin_distance = std::sqrt(
      estimate.other_end.dot(estimate.covariance.ldlt().solve(estimate.other_end)));
  flag(basin_distance > 3.0, "wrong_basin");
  flag(estimate.scores.num_active < 0.25 * static_cast<double>(num_points),
       "low_support");
  flag(96.0 * estimate.kappa_48 / estimate.kappa_inf < 30.0, "few_patches");
  flag(estimate.residual_scale > 2.0 || estimate.kappa_inf > 10.0, "misfit");
  return notes + "prior_only=" + std::to_string((estimate.keep.array() == 0.0).count());
}

MethodResult
resultOf(const CalibratedEstimate& estimate, Eigen::Index num_points)
{
  MethodResult result;
  result.is_valid = true;
  result.mean = movedBy(estimate.mean, estimate.centre, estimate.mode);
  result.covariance = estimate.covariance;
  result.centre = estimate.centre;
  result.notes = notesOf(estimate, num_points);
  result.num_queries = estimate.num_queries;
  return result;
}

[[maybe_unused]] void
addDraws(const ChainSet& chains, MethodResult& result)
{
  Eigen::Index num_draws = 0;
  for (const Chain& chain : chains.chains)
    num_draws += chain.draws.rows();
  result.draws.resize(num_draws, 6);
  Eigen::Index row = 0;
  for (const Chain& chain : chains.chains) {
    result.draws.middleRows(row, chain.draws.rows()) = chain.draws;
    row += chain.draws.rows();
  }
  // Those of the draws are not counted.
  result.num_queries = -1;
}

/** The modes of the pipeline: one where the prior is narrow. */
std::vector<CalibratedMode>
modesOf(const SurfaceScorer& scorer, const Prior& prior)
{
  const CalibratedEstimate first = estimateCalibrated(scorer, prior);
  if (!mayHaveSeveralModes(scorer, prior))
    return {{first, 0.0}};
  return significantModes(findModes(scorer, prior, first).modes);
}

MethodResult
runWith(const CoverageCase& problem, bool has_draws)
{
  const SurfaceModel model(problem.target, SurfaceModelOptions(), 1);
  const SurfaceScorer scorer(thinnedSource(problem), model);
  const Prior prior = priorOf(problem);
  const std::vector<CalibratedMode> modes = modesOf(scorer, prior);
  MethodResult result = resultOf(modes.front().estimate, scorer.sourcePoints().cols());
  if (has_draws) {
    ChainOptions options;
    options.seed = problem.seed;
    options.num_threads = 1;
#ifdef HAS_CALIBRATED_DRAWS
    addDraws(sampleCalibrated(scorer, prior, modes, options), result);
#endif
    result.is_valid = result.draws.rows() > 0;
  }
  return result;
}

} // namespace

MethodResult
runCalibrated(const CoverageCase& problem)
{
  return runWith(problem, false);
}

MethodResult
runCalibratedDraws(const CoverageCase& problem)
{
  return runWith(problem, true);
}

} // namespace bayesian_icp::evaluate
