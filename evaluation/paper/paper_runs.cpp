#include "paper/paper_runs.h"

#include "coverage/coverage_score.h"
#include "geometry/twist.h"
#include "io/picture_numbers.h"
#include "study/draw_statistics.h"

#include <algorithm>

namespace bayesian_icp::evaluate {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/** Results of the baseline that the energy score is a mean over. */
constexpr Eigen::Index max_outcomes = 400;

Vector6d
priorSd()
{
  return PriorOptions().variance.cwiseSqrt();
}

/** Whether the coordinates vary by more than rounding, whatever the others are. */
bool
isRegular(const Matrix6d& covariance)
{
  const auto factor = factorOf(covariance);
  return factor && (factor->diagonal().array() / covariance.diagonal().array().sqrt())
                           .minCoeff() > 1e-6;
}

void
addBaselineScores(const PoseMatrix& draws,
                  const PaperBaseline& baseline,
                  DistributionRun& run)
{
  const Moments moments = momentsOf(draws);
  run.mean = moments.mean;
  run.standard_deviation = moments.covariance.diagonal().cwiseSqrt();
  if (baseline.main_ends.rows() > 1) {
    const Moments main = momentsOf(unwrapAbout(baseline.mean, baseline.main_ends));
    // Few ends, or the same one again and again, have a singular covariance.
    run.main_kl = isRegular(main.covariance) ? gaussianKl(main, moments) : unknown;
    for (int k = 0; k < 6; ++k)
      run.main_coordinate_kl[k] = gaussianKl(main, moments, k);
  }
  const Vector6d scale = priorSd().cwiseInverse();
  const PoseMatrix outcomes = unwrapAbout(
      baseline.mean,
      baseline.ends(io::evenlySpaced(baseline.ends.rows(), max_outcomes), Eigen::all));
  run.energy_score =
      energyScore(draws * scale.asDiagonal(), outcomes * scale.asDiagonal());
}

void
addTruthScores(const ScanPair& pair,
               const PoseMatrix& draws,
               std::uint64_t seed,
               DistributionRun& run)
{
  CoverageCase problem;
  problem.seed = seed;
  problem.source = pair.source;
  problem.truth = pair.truth;
  problem.prior_sd = priorSd();
  problem.truth_sd = pair.truth_sd;
  MethodResult result;
  result.is_valid = true;
  result.mean = isometryOf(meanPose(draws));
  result.centre = result.mean * Eigen::Vector3d(pair.source.rowwise().mean());
  result.draws = draws;
  const CoverageScore score = coverageScoreOf(problem, result);
  run.nees = score.nees;
  run.truth_energy_score = score.energy_score;
  run.translation_error = score.translation_error;
  run.rotation_error = score.rotation_error;
}

} // namespace

DistributionRun
distributionRunOf(const PaperRunName& name,
                  const ScanPair& pair,
                  const SamplerRun& run,
                  const PaperBaseline& baseline)
{
  DistributionRun scored;
  scored.name = name;
  scored.score = scoreOf(run, baseline.ends);
  const PoseMatrix draws = pooledDraws(run.chains.chains);
  if (draws.rows() < min_scored_draws)
    return scored;
  addBaselineScores(unwrapAbout(baseline.mean, draws), baseline, scored);
  addTruthScores(pair, draws, name.seed, scored);
  return scored;
}

PoseMatrix
partOf(const ChainSet& chains, const DrawPart& part)
{
  if (chains.chains.empty())
    return PoseMatrix(0, 6);
  const auto num_chains = static_cast<Eigen::Index>(chains.chains.size());
  const Eigen::Index first = part.first / num_chains, count = part.count / num_chains;
  std::vector<PoseMatrix> parts;
  for (const Chain& chain : chains.chains)
    if (!chain.diverged) {
      const Eigen::Index begin = std::min(first, chain.draws.rows());
      parts.push_back(
          chain.draws.middleRows(begin, std::min(count, chain.draws.rows() - begin)));
    }
  return pooled(parts);
}

CurveDivergences
curveDivergences(const PoseMatrix& draws, const PaperBaseline& baseline)
{
  CurveDivergences divergences;
  divergences.setConstant(infinity);
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
