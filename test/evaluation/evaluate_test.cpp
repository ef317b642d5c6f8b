// The evaluation app's own pieces: distances against closed forms, scores of good and
// bad draws.
#include "evaluation/csv_rows.h"
#include "evaluation/evaluate_test_support.h"
#include "samplers/score.h"
#include "study/draw_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

using namespace bayesian_icp;
using namespace bayesian_icp::evaluate;

TEST(DrawStatistics, KlOfGaussiansIsTheClosedForm)
{
  Moments p, q;
  p.covariance = Matrix6d::Identity();
  q.covariance = Vector6d(4.0 * Vector6d::Ones()).asDiagonal();
  q.mean[2] = 3.0;
  // Each coordinate: (1/4 + shift^2/4 - 1 + log 4) / 2.
  const double without_shift = 0.5 * (0.25 - 1.0 + std::log(4.0));
  EXPECT_NEAR(gaussianKl(p, q, 0), without_shift, 1e-12);
  EXPECT_NEAR(gaussianKl(p, q, 2), without_shift + 9.0 / 8.0, 1e-12);
  EXPECT_NEAR(gaussianKl(p, q), 6.0 * without_shift + 9.0 / 8.0, 1e-12);
  EXPECT_NEAR(gaussianKl(p, p), 0.0, 1e-12);
}

TEST(DrawStatistics, KlDoesNotChangeUnderLinearMaps)
{
  Moments p = exampleGaussian(), q = p;
  q.mean[0] += 0.002;
  q.covariance.row(5) *= 1.5;
  q.covariance.col(5) *= 1.5;
  Matrix6d map = Matrix6d::Identity();
  map(0, 3) = 2.0;
  map(4, 1) = -5.0;
  const auto moved = [&map](const Moments& m) {
    return Moments{map * m.mean, map * m.covariance * map.transpose()};
  };
  EXPECT_GT(gaussianKl(p, q), 1.0);
  EXPECT_NEAR(gaussianKl(moved(p), moved(q)), gaussianKl(p, q), 1e-8);
}

TEST(DrawStatistics, KlToADegenerateGaussianIsInfinite)
{
  Moments p, q;
  p.covariance = Matrix6d::Identity();
  EXPECT_TRUE(std::isinf(gaussianKl(p, q)));
  EXPECT_TRUE(std::isinf(gaussianKl(p, q, 1)));
}

TEST(DrawStatistics, DistancesOfDistributionFunctionsAreTheClosedForms)
{
  const Eigen::VectorXd a = Eigen::VectorXd::LinSpaced(5, 0.0, 4.0);
  const Eigen::VectorXd shifted = a.array() + 0.25;
  EXPECT_NEAR(wasserstein1(a, shifted), 0.25, 1e-12);
  EXPECT_NEAR(kolmogorovSmirnov(a, shifted), 0.2, 1e-12);
  EXPECT_NEAR(wasserstein1(a, a), 0.0, 1e-12);
  EXPECT_NEAR(kolmogorovSmirnov(a, a), 0.0, 1e-12);
  // A point at 0 against half at 0, half at 1; of different sizes and unsorted.
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(3);
  const Eigen::Vector4d halves(1.0, 0.0, 1.0, 0.0);
  EXPECT_NEAR(wasserstein1(zero, halves), 0.5, 1e-12);
  EXPECT_NEAR(kolmogorovSmirnov(zero, halves), 0.5, 1e-12);
  EXPECT_NEAR(wasserstein1(halves, zero), 0.5, 1e-12);
}

TEST(DrawStatistics, AnglesAreUnwrappedAboutTheCentre)
{
  const double pi = std::acos(-1.0);
  PoseMatrix draws = PoseMatrix::Zero(2, 6);
  draws(0, 5) = pi - 0.1;
  draws(1, 5) = -pi + 0.1;
  Vector6d centre = Vector6d::Zero();
  centre[5] = pi;
  const PoseMatrix unwrapped = unwrapAbout(centre, draws);
  EXPECT_NEAR(unwrapped(0, 5), pi - 0.1, 1e-12);
  EXPECT_NEAR(unwrapped(1, 5), pi + 0.1, 1e-12);
}

TEST(Score, JudgesGoodAndBadDraws)
{
  Moments gaussian = exampleGaussian();
  gaussian.mean[5] = 3.1; // draws of yaw lie on both sides of pi
  const PoseMatrix gold = gaussianDraws(gaussian, 20000, 1);
  SamplerRun run;
  run.seconds = 2.0;
  for (std::uint64_t seed = 2; seed < 6; ++seed) {
    Chain chain;
    chain.draws = gaussianDraws(gaussian, 500, seed);
    run.chains.chains.push_back(chain);
  }
  const Score good = scoreOf(run, gold);
  EXPECT_LT(good.kl, 0.05);
  EXPECT_LT(good.kolmogorov_smirnov.maxCoeff(), 0.06);
  EXPECT_EQ(good.num_draws, 2000.0);
  EXPECT_GT(good.essPerSecond(), 500.0);
  EXPECT_EQ(good.status, "ok");

  for (Chain& chain : run.chains.chains)
    chain.draws.col(1).array() += 3.0 * std::sqrt(gaussian.covariance(1, 1));
  const Score shifted = scoreOf(run, gold);
  EXPECT_NEAR(shifted.coordinate_kl[1], 4.5, 0.5);
  EXPECT_NEAR(shifted.wasserstein[1], 3.0, 0.1);
  EXPECT_GT(shifted.kolmogorov_smirnov[1], 0.8);
  EXPECT_LT(shifted.coordinate_kl[2], 0.01);

  EXPECT_TRUE(std::isinf(scoreOf(SamplerRun(), gold).kl));
}

TEST(ResultTable, ShowsMediansAndWorstOfTheBestStepSize)
{
  std::vector<ScoredRun> runs;
  for (const double kl : {0.3, 0.1, 0.2}) {
    ScoredRun run;
    run.name = {"can", 0.0015, 1000.0, "paper 1e-05", runs.size() + 1, ""};
    run.score.kl = kl;
    run.score.status = "ok";
    run.score.seconds = 1.0;
    runs.push_back(run);
  }
  runs.push_back(runs[0]);
  runs.back().name.sampler = "paper 0.001"; // only tried once
  std::ostringstream table;
  samplerTable(runs).print(table);
  for (const char* line :
       {"can, sigma 0.0015 m, N 1000\n", "\n  paper 1e-05     3  0.2000  0.3000  "})
    expectIn(table.str(), line);
  EXPECT_EQ(count("paper 0.001", table.str()), 0);
  // Of other points or a longer gold standard.
  runs.push_back(runs[0]);
  runs.back().name.gold_key = "other";
  std::ostringstream both;
  samplerTable(runs).print(both);
  expectIn(both.str(), ", gold standard other\n  paper 1e-05     1  0.3000");
}
