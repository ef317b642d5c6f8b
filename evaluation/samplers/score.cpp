#include "samplers/score.h"

#include "io/picture_numbers.h"
#include "study/draw_statistics.h"
#include "summary/estimates.h"

#include <boost/range/algorithm/max_element.hpp>
#include <boost/range/algorithm/min_element.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <tuple>

namespace bayesian_icp::evaluate {

namespace {

/** Draws of the gold standard that distribution functions are made of. */
constexpr Eigen::Index num_compared_draws = 20000;

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

/** Kolmogorov-Smirnov distance below which a marginal counts as right. */
constexpr double good_ks = 0.06;

using CellName = std::tuple<std::string, double, double>;
using Scores = std::vector<Score>;

template <typename Number>
std::vector<double>
collect(const Scores& scores, const Number& number)
{
  std::vector<double> values;
  for (const Score& score : scores)
    values.push_back(std::invoke(number, score));
  return values;
}

double
medianCoordinateKl(const Scores& scores)
{
  std::vector<double> values;
  for (const Score& score : scores)
    values.insert(values.end(), score.coordinate_kl.begin(), score.coordinate_kl.end());
  return median(values);
}

double
shareOfGoodMarginals(const Scores& scores)
{
  double num_good = 0.0;
  for (const Score& score : scores)
    num_good +=
        static_cast<double>((score.kolmogorov_smirnov.array() < good_ks).count());
  return num_good / (6.0 * static_cast<double>(scores.size()));
}

std::vector<std::string>
cellsOf(const std::string& sampler, const Scores& scores)
{
  const auto kl = collect(scores, &Score::kl);
  const auto seconds = collect(scores, &Score::seconds);
  const auto rate = collect(scores, &Score::essPerSecond);
  const auto rhat = collect(scores, &Score::rhat);
  const auto bulk = collect(scores, &Score::bulk_ess);
  const auto tail = collect(scores, &Score::tail_ess);
  const auto w1 =
      collect(scores, [](const Score& s) { return s.wasserstein.maxCoeff(); });
  const auto num_mixed = std::count_if(
      scores.begin(), scores.end(), [](const Score& s) { return s.status == "ok"; });
  return {sampler,
          std::to_string(scores.size()),
          numberText(median(kl), 4),
          numberText(*boost::max_element(kl), 4),
          numberText(medianCoordinateKl(scores), 4),
          numberText(median(w1), 3),
          numberText(100.0 * shareOfGoodMarginals(scores), 0),
          numberText(*boost::max_element(rhat), 3),
          numberText(*boost::min_element(bulk), 0),
          numberText(*boost::min_element(tail), 0),
          numberText(median(rate), 1),
          numberText(median(seconds), 3),
          std::to_string(num_mixed)};
}

/** "paper" of "paper 1e-05": the samplers that differ by their step size. */
std::string
familyOf(const std::string& sampler)
{
  const std::string family = sampler.substr(0, sampler.find(' '));
  return family == "paper" || family == "mala" ? family : sampler;
}

/** Step sizes that were tried less often than others of the family are left out. */
void
addCell(const std::string& title,
        const std::map<std::string, Scores>& samplers,
        TextTable& table)
{
  table.addTitle(title);
  std::map<std::string, std::size_t> most_runs;
  for (const auto& [sampler, scores] : samplers) {
    std::size_t& most = most_runs[familyOf(sampler)];
    most = std::max(most, scores.size());
  }
  for (const auto& [sampler, scores] : samplers)
    if (scores.size() == most_runs[familyOf(sampler)])
      table.add(cellsOf(sampler, scores));
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

TextTable
samplerTable(const std::vector<ScoredRun>& runs)
{
  using ScoresOfSamplers = std::map<std::string, Scores>;
  std::map<CellName, std::map<std::string, ScoresOfSamplers>> cells; // and gold keys
  for (const ScoredRun& run : runs)
    cells[{run.name.scene, run.name.sigma, run.name.effective_points}]
         [run.name.gold_key][run.name.sampler]
             .push_back(run.score);
  TextTable table({"\nsampler",
                   "\nruns",
                   "6-D KL\nmedian",
                   "6-D KL\nworst",
                   "1-D KL\nmedian",
                   "W1\nmedian",
                   "KS<.06\n%",
                   "R-hat\nworst",
                   "bulk ESS\nsmallest",
                   "tail ESS\nsmallest",
                   "ESS/s\nmedian",
                   "CPU [s]\nmedian",
                   "mixed\nruns"});
  for (const auto& [cell, standards] : cells)
    for (const auto& [gold_key, samplers] : standards) {
      const auto& [scene, sigma, effective_points] = cell;
      addCell(scene + format(", sigma %g m, N %g", sigma, effective_points) +
                  (standards.size() > 1 ? ", gold standard " + gold_key : ""),
              samplers,
              table);
    }
  return table;
}

} // namespace bayesian_icp::evaluate
