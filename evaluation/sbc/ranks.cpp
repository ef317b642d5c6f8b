#include "sbc/ranks.h"

#include "coverage/coverage_cases.h"
#include "coverage/coverage_methods.h"
#include "io/coordinates.h"
#include "io/numbers.h"
#include "sbc/rank_models.h"
#include "summary/estimates.h"

#include <bayesian_icp/pipeline.h>

#include <array>
#include <cmath>

namespace bayesian_icp::evaluate {

namespace {

Vector6d
coordinatesOf(const Vector6d& pose, const Prior& prior)
{
  Vector6d coordinates = prior.deviation(pose);
  for (int k = 3; k < 6; ++k)
    coordinates[k] = wrapAngle(coordinates[k]);
  return coordinates;
}

/** Of the models' random numbers; draws use other streams of the same seed. */
constexpr std::uint64_t model_stream = 0x736263;

std::optional<Ranks>
runExactPreset(std::uint64_t seed, ExactSteps steps)
{
  Random random(seed, model_stream);
  const FarPointsModel model(random);
  Options options;
  options.preset = Preset::Exact;
  options.exact.scale.effective_points = static_cast<double>(model.source.cols());
  options.exact.scale.measurement_sigma = model.noise;
  options.prior.mean = model.prior.mean();
  options.prior.variance = model.prior.variance();
  options.exact.steps = steps;
  options.chains.seed = seed;
  options.chains.num_threads = 1;
  const PosteriorEstimate estimate = estimatePosterior(
      model.source, KdTree(model.target.cast<float>(), 1), model.prior.mean(), options);
  if (!hasUsableMean(estimate.summary.status))
    return std::nullopt;
  return ranksOf(model.truth, estimate.samples, model.prior);
}

std::optional<Ranks>
runLinearScores(std::uint64_t seed)
{
  Random random(seed, model_stream);
  const LinearScoreModel model(seed % 2 == 1, random);
  ChainOptions options;
  options.seed = seed;
  options.num_threads = 1;
  const ChainSet chains = sampleCalibrated(
      model.score(), model.prior, {{model.estimate}}, CalibratedOptions(), options);
  const PosteriorEstimate estimate = {
      summarize(chains), {}, pooledDraws(chains.chains)};
  if (!hasUsableMean(estimate.summary.status))
    return std::nullopt;
  return ranksOf(model.truth, estimate.samples, model.prior);
}

std::optional<Ranks>
runScans(std::uint64_t seed)
{
  const auto& scenes = tunedScenes();
  const CoverageCase problem =
      makeCoverageCase(scenes[seed % scenes.size()], "same", seed);
  const MethodResult result = runCalibratedDraws(problem);
  if (!result.is_valid)
    return std::nullopt;
  return ranksOf(poseOf(problem.truth.matrix()), result.draws, priorOf(problem));
}

} // namespace

Ranks
ranksOf(const Vector6d& true_pose, const PoseMatrix& draws, const Prior& prior)
{
  const Vector6d truth = coordinatesOf(true_pose, prior);
  const Eigen::Index step = draws.rows() / num_ranked_draws;
  Ranks ranks = Ranks::Zero();
  for (int i = 0; i < num_ranked_draws; ++i) {
    const Vector6d draw = coordinatesOf(draws.row(step * i).transpose(), prior);
    ranks += (draw.array() < truth.array()).cast<int>().matrix();
  }
  return ranks;
}

double
chiSquareOf(const std::vector<Ranks>& runs, int k)
{
  std::array<int, num_rank_bins> histogram = {};
  for (const Ranks& ranks : runs)
    ++histogram[static_cast<std::size_t>(ranks[k] * num_rank_bins /
                                         (num_ranked_draws + 1))];
  const double expected = static_cast<double>(runs.size()) / num_rank_bins;
  double sum = 0.0;
  for (const int count : histogram)
    sum += (count - expected) * (count - expected) / expected;
  return sum;
}

std::vector<RankSampler>
rankSamplers()
{
  return {
      {"exact-langevin",
       true,
       [](std::uint64_t seed) { return runExactPreset(seed, ExactSteps::Langevin); }},
      {"exact-metropolis",
       true,
       [](std::uint64_t seed) { return runExactPreset(seed, ExactSteps::Metropolis); }},
      {"calibrated", true, runLinearScores},
      {"calibrated-scans", false, runScans}};
}

RankVerdict
verdictOf(const std::vector<RankRun>& runs)
{
  std::vector<std::string> header = {"sampler", "valid/runs"};
  header.insert(
      header.end(), app::coordinate_names.begin(), app::coordinate_names.end());
  header.emplace_back("verdict");
  RankVerdict result{{header}};
  for (const RankSampler& sampler : rankSamplers()) {
    std::vector<Ranks> ranks; // of good runs
    std::size_t num_runs = 0;
    for (const RankRun& run : runs) {
      num_runs += run.name.sampler == sampler.name ? 1 : 0;
      if (run.name.sampler == sampler.name && run.is_valid)
        ranks.push_back(run.ranks);
    }
    if (num_runs == 0)
      continue;
    std::vector<std::string> cells = {
        sampler.name, std::to_string(ranks.size()) + '/' + std::to_string(num_runs)};
    const bool is_enough = ranks.size() >= min_ranked_runs;
    bool is_uniform = ranks.size() == num_runs;
    for (int k = 0; k < 6; ++k) {
      const double statistic = ranks.empty() ? std::nan("") : chiSquareOf(ranks, k);
      is_uniform = is_uniform && (!is_enough || statistic < max_rank_chi_square);
      cells.push_back(ranks.empty() ? "-" : io::fixedTextOf(statistic, 1));
    }
    cells.emplace_back(!sampler.is_well_specified
                           ? "no model of the scans: for information"
                       : !is_uniform ? "NOT UNIFORM"
                       : is_enough   ? "uniform"
                                     : "too few runs");
    result.rows.push_back(cells);
    result.are_uniform &= is_uniform || !sampler.is_well_specified;
  }
  return result;
}

} // namespace bayesian_icp::evaluate
