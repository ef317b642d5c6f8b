/** \file
 * \brief Simulation-based calibration with few runs and fixed seeds. Where ranks have
 * to be uniform, the chi-square statistic of a coordinate is above its bound with a
 * probability of 0.1 %.
 */
#include "calibrated/draws/product_coordinates.h"
#include "sbc/rank_models.h"
#include "sbc/ranks.h"
#include "study/named.h"

#include <bayesian_icp/summary.h>

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace bayesian_icp::evaluate {
namespace {

/** The largest statistic of the six coordinates. */
double
largestChiSquare(const std::vector<Ranks>& runs)
{
  double largest = 0.0;
  for (int k = 0; k < 6; ++k)
    largest = std::max(largest, chiSquareOf(runs, k));
  return largest;
}

void
expectUniformRanks(const std::string& name, int num_runs)
{
  const std::vector<RankSampler> samplers = rankSamplers();
  const RankSampler* const sampler = findNamed(samplers, name);
  ASSERT_NE(sampler, nullptr);
  std::vector<Ranks> runs;
  for (int seed = 1; seed <= num_runs; ++seed)
    if (const auto ranks = sampler->run(static_cast<std::uint64_t>(seed)))
      runs.push_back(*ranks);
  EXPECT_EQ(runs.size(), static_cast<std::size_t>(num_runs));
  EXPECT_LT(largestChiSquare(runs), max_rank_chi_square);
}

/** 2000 draws at zero but for the x of some. */
PoseMatrix
drawsWithX(double first, double second)
{
  PoseMatrix draws = PoseMatrix::Zero(2000, 6);
  draws.topRows(1000).col(0).setConstant(first);
  draws.bottomRows(1000).col(0).setConstant(second);
  return draws;
}

TEST(SimulationBasedCalibration, RanksOfCalibratedDrawsAreUniform)
{
  expectUniformRanks("calibrated", 200);
}

TEST(SimulationBasedCalibration, RanksOfExactLangevinDrawsAreUniform)
{
  expectUniformRanks("exact-langevin", 60);
}

/** The positive control: with a third of the covariance J, 200 runs show it. */
TEST(SimulationBasedCalibration, RanksOfNarrowDrawsAreNot)
{
  std::vector<Ranks> runs;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed, 0);
    const LinearScoreModel model(false, random);
    CalibratedEstimate narrow = model.estimate;
    narrow.score_covariance /= 3.0;
    narrow.information *= 3.0;
    narrow.covariance = (narrow.information + narrow.prior.precision).inverse();
    ChainOptions options;
    options.seed = seed;
    options.num_threads = 1;
    const ChainSet chains = sampleCalibrated(
        model.score(), model.prior, {{narrow}}, CalibratedOptions(), options);
    runs.push_back(ranksOf(model.truth, pooledDraws(chains.chains), model.prior));
  }
  EXPECT_GT(largestChiSquare(runs), 2.0 * max_rank_chi_square);
}

TEST(LinearScoreModel, HasScoresAboutTheTruthWithTheStatedCovariance)
{
  constexpr int num_models = 300;
  for (const bool is_yaw_free : {false, true}) {
    double sum = 0.0;
    for (std::uint64_t seed = 1; seed <= num_models; ++seed) {
      Random random(seed, 0);
      const LinearScoreModel model(is_yaw_free, random);
      const CalibratedEstimate& e = model.estimate;
      // The truth is z = (a, b) again once its free part is taken off.
      const ProductCoordinates coordinates(e);
      const Vector6d held = coordinates.heldPart(isometryOf(model.truth));
      std::vector<std::size_t> all(400);
      for (std::size_t i = 0; i < all.size(); ++i)
        all[i] = i;
      Vector6d score;
      PatchHints hints;
      model.score()(e, coordinates.scoredPose(held), all, hints, score);
      sum += score.dot(e.score_covariance.ldlt().solve(score));
    }
    // A chi-square variable with 6 degrees of freedom a model; 4.9 standard errors.
    EXPECT_NEAR(sum, 6.0 * num_models, 4.9 * std::sqrt(12.0 * num_models));
  }
}

TEST(FarPointsModel, HasUnambiguousNeighbors)
{
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed, 0);
    const FarPointsModel model(random);
    for (const Vector6d& pose : {model.truth, model.prior.mean()}) {
      const Eigen::Matrix3Xd moved = isometryOf(pose) * model.source;
      // Half the distance of neighbours is 0.75 m.
      EXPECT_LT((moved - model.target).colwise().norm().maxCoeff(), 0.6);
    }
  }
}

TEST(DrawFromPrior, HasTheMomentsOfThePrior)
{
  Vector6d mean, variance;
  mean << 1.0, -2.0, 0.5, 0.3, -0.2, 2.0;
  variance << 0.04, 0.01, 0.09, 0.02, 0.5, 2.0;
  const Prior prior(mean, variance, Eigen::Vector3d(0.5, 1.0, -2.0));
  constexpr int num_draws = 20000;
  Random random(7, 0);
  Vector6d second_moments = Vector6d::Zero();
  Vector6d cosines = Vector6d::Zero();
  for (int i = 0; i < num_draws; ++i) {
    const Vector6d deviation = prior.deviation(drawFrom(prior, random));
    second_moments += deviation.cwiseAbs2() / num_draws;
    cosines += deviation.array().cos().matrix() / num_draws;
  }
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(second_moments[k] / variance[k], 1.0, 4.9 * std::sqrt(2.0 / num_draws));
  for (int k = 3; k < 6; ++k) {
    // Mean of cos of a von Mises variate: I1 / I0; its variance is at most 1/2.
    const double kappa = 1.0 / variance[k];
    const double expected =
        std::cyl_bessel_i(1.0, kappa) / std::cyl_bessel_i(0.0, kappa);
    const double cos_variance = 1.0 - expected / kappa - expected * expected;
    EXPECT_NEAR(cosines[k], expected, 4.9 * std::sqrt(cos_variance / num_draws)) << k;
  }
}

TEST(Ranks, CountDrawsBelowTheTruth)
{
  const Prior prior(Vector6d::Zero(), Vector6d::Ones());
  Vector6d truth = Vector6d::Constant(-0.5);
  truth[0] = 0.5;
  const Ranks between = ranksOf(truth, drawsWithX(0.0, 1.0), prior);
  EXPECT_EQ(between[0], 50); // draws 0, 20, ... 980
  EXPECT_EQ(between[1], 0);
  EXPECT_EQ(ranksOf(truth, drawsWithX(0.0, 0.1), prior)[0], num_ranked_draws);
}

TEST(Ranks, VerdictIsOfGoodRunsAlone)
{
  std::vector<RankRun> runs;
  for (std::uint64_t k = 0; k < 50; ++k)
    for (const char* sampler : {"calibrated", "calibrated-scans"})
      runs.push_back({{sampler, k}, true, Ranks::Constant(static_cast<int>(2 * k))});
  const RankVerdict good = verdictOf(runs);
  EXPECT_TRUE(good.are_uniform);
  EXPECT_EQ(good.rows.at(1).at(1), "50/50");
  EXPECT_EQ(good.rows.at(1).back(), "uniform");
  EXPECT_EQ(good.rows.at(2).back(), "no model of the scans: for information");
  // Of 49 runs, less than five are expected in each of ten bins.
  const RankVerdict few = verdictOf({runs.begin() + 2, runs.end()});
  EXPECT_TRUE(few.are_uniform);
  EXPECT_EQ(few.rows.at(1).back(), "too few runs");
  runs[1].is_valid = false;
  EXPECT_TRUE(verdictOf(runs).are_uniform);
  runs[0].is_valid = false;
  EXPECT_FALSE(verdictOf(runs).are_uniform);
}

TEST(Ranks, ChiSquareOfBins)
{
  std::vector<Ranks> even;
  for (int i = 0; i <= num_ranked_draws; ++i)
    even.push_back(Ranks::Constant(i));
  EXPECT_EQ(chiSquareOf(even, 3), 0.0);
  // All in one bin of ten: (n - n/10)^2 / (n/10) + 9 n/10 = 9 n.
  EXPECT_DOUBLE_EQ(chiSquareOf(std::vector<Ranks>(50, Ranks::Constant(99)), 0), 450.0);
}

} // namespace
} // namespace bayesian_icp::evaluate
