#include "samplers/score.h"

#include "io/picture_numbers.h"
#include "study/draw_statistics.h"
#include "study/text_table.h"
#include "summary/estimates.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp::evaluate {

namespace {

/** Draws of the gold standard that distribution functions are made of. */
constexpr Eigen::Index num_compared_draws = 20000;

/** Kolmogorov-Smirnov distance below which a marginal counts as right. */
constexpr double good_ks = 0.06;

void
addDiagnostics(const Summary& summary, Score& score)
{
  score.bulk_ess = score.tail_ess = std::numeric_limits<double>::infinity();
  for (const CoordinateSummary& coordinate : summary.coordinates) {
    // Undefined is as bad as it gets.
    const bool is_defined =
        !std::isnan(coordinate.rhat + coordinate.bulk_ess + coordinate.tail_ess);
    score.rhat = std::max(score.rhat,
                          is_defined ? coordinate.rhat
                                     : std::numeric_limits<double>::infinity());
    score.bulk_ess = std::min(score.bulk_ess, is_defined ? coordinate.bulk_ess : 0.0);
    score.tail_ess = std::min(score.tail_ess, is_defined ? coordinate.tail_ess : 0.0);
  }
}

} // namespace

Score
scoreOf(const SamplerRun& run, const PoseMatrix& gold_draws)
{
  const Summary summary = run.summary ? *run.summary : summarize(run.chains);
  Score score;
  score.status = run.status.empty() ? toString(summary.status) : run.status;
  score.seconds = run.seconds;
  addDiagnostics(summary, score);
  const PoseMatrix pooled_draws = pooledDraws(run.chains.chains);
  score.num_draws = static_cast<double>(pooled_draws.rows());
  if (pooled_draws.rows() < min_scored_draws) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    score.kl = infinity;
    score.coordinate_kl.setConstant(infinity);
    score.wasserstein.setConstant(infinity);
    score.kolmogorov_smirnov.setOnes();
    return score;
  }
  const Vector6d centre = coordinateMeans(gold_draws);
  const PoseMatrix reference = unwrapAbout(centre, gold_draws);
  const PoseMatrix draws = unwrapAbout(centre, pooled_draws);
  const Moments p = momentsOf(reference), q = momentsOf(draws);
  score.kl = gaussianKl(p, q);
  const auto compared = io::evenlySpaced(reference.rows(), num_compared_draws);
  for (int k = 0; k < 6; ++k) {
    const SampleDistance distance =
        distanceBetween(reference(compared, k), draws.col(k));
    score.coordinate_kl[k] = gaussianKl(p, q, k);
    score.wasserstein[k] = distance.wasserstein / std::sqrt(p.covariance(k, k));
    score.kolmogorov_smirnov[k] = distance.kolmogorov_smirnov;
  }
  return score;
}

std::string
summaryOf(const std::vector<ScoredRun>& runs)
{
  std::vector<GroupedNumbers> numbers;
  for (const auto& [name, score] : runs)
    numbers.push_back(
        {name.scene +
             format(", sigma %g m, N %g, ", name.sigma, name.effective_points) +
             name.sampler,
         {score.kl,
          score.kl,
          score.wasserstein.maxCoeff(),
          (score.kolmogorov_smirnov.array() < good_ks).cast<double>().mean(),
          score.rhat,
          score.bulk_ess,
          score.tail_ess,
          score.essPerSecond(),
          score.seconds,
          score.status == "ok" ? 1.0 : 0.0}});
  return summaryText("runs of",
                     {{"KL, median"},
                      {"worst", largest},
                      {"W1"},
                      {"KS < .06", mean},
                      {"R-hat, worst", largest},
                      {"bulk ESS, least", smallest},
                      {"tail ESS", smallest},
                      {"ESS/s"},
                      {"CPU [s]"},
                      {"mixed", mean}},
                     numbers);
}

} // namespace bayesian_icp::evaluate
