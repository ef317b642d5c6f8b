// The gold standard of the evaluation app: Metropolis runs on densities whose moments
// are known.
#include "evaluation/evaluate_test_support.h"
#include "samplers/gold_standard.h"
#include "samplers/sampler_runs.h"
#include "samplers/score.h"
#include "support/test_support.h"

#include <bayesian_icp/diagnostics.h>

#include <gtest/gtest.h>

#include <cmath>

using namespace bayesian_icp;
using namespace bayesian_icp::evaluate;

namespace {

EnergyFunction
energyOf(const Moments& gaussian)
{
  const Eigen::LLT<Matrix6d> llt(gaussian.covariance);
  return [=](const Vector6d& x) {
    return 0.5 * llt.matrixL().solve(x - gaussian.mean).squaredNorm();
  };
}

/** Mean and variance of each coordinate within five Monte Carlo standard errors. */
void
expectMoments(const std::vector<PoseMatrix>& chains, const Moments& truth)
{
  for (int k = 0; k < 6; ++k) {
    Eigen::MatrixXd values(chains[0].rows(), static_cast<Eigen::Index>(chains.size()));
    for (std::size_t i = 0; i < chains.size(); ++i)
      values.col(static_cast<Eigen::Index>(i)) = chains[i].col(k);
    const Eigen::MatrixXd squares = (values.array() - truth.mean[k]).square();
    EXPECT_NEAR(values.mean(), truth.mean[k], 5.0 * mcseMean(values)) << k;
    EXPECT_NEAR(squares.mean(), truth.covariance(k, k), 5.0 * mcseMean(squares)) << k;
    // The errors above are not so wide that anything passes.
    EXPECT_LT(mcseMean(values), 0.1 * std::sqrt(truth.covariance(k, k))) << k;
  }
}

GoldTarget
goldTarget(const EnergyFunction& energy, double spread)
{
  GoldTarget target;
  target.make_energy = [energy]() { return energy; };
  target.start_spread = Vector6d::Constant(spread);
  target.draw_start = [spread](Random& random) -> Vector6d {
    return spread * random.normal6();
  };
  return target;
}

const auto no_report = [](const std::string&) {};

} // namespace

TEST(MetropolisRuns, WalkAndMalaReachTheMomentsOfAGaussian)
{
  const Moments gaussian = exampleGaussian();
  const EnergyFunction energy = energyOf(gaussian);
  const Eigen::LLT<Matrix6d> llt(gaussian.covariance);
  const Matrix6d factor = llt.matrixL();
  const GradientFunction with_gradient = [&](const Vector6d& x, Vector6d& gradient) {
    gradient = llt.solve(x - gaussian.mean);
    return energy(x);
  };
  std::vector<PoseMatrix> walks, malas;
  for (std::uint64_t stream = 0; stream < 4; ++stream) {
    Random random(5, stream);
    const Vector6d start = gaussian.mean + factor * random.normal6();
    walks.push_back(runRandomWalk(start, energy, factor, 20000, random));
    malas.push_back(runMala(start, with_gradient, factor, 0.8, 10000, random));
  }
  expectMoments(walks, gaussian);
  expectMoments(malas, gaussian);
}

TEST(GoldStandard, ConvergesToAGaussianFromFarAway)
{
  const Moments gaussian = exampleGaussian();
  const GoldStandard gold =
      sampleGold(goldTarget(energyOf(gaussian), 5.0), GoldOptions(), no_report);
  EXPECT_TRUE(gold.has_converged);
  expectMoments(gold.chains, gaussian);
  EXPECT_LT(gaussianKl(gaussian, momentsOf(pooled(gold.chains))), 0.01);
}

TEST(GoldStandard, WeighsTwoModes)
{
  // One third of the mass at x = -3, two thirds at x = 3.
  const EnergyFunction energy = [](const Vector6d& x) {
    const double rest = 0.5 * x.tail<5>().squaredNorm();
    const double left = -0.5 * std::pow(x[0] + 3.0, 2);
    const double right = -0.5 * std::pow(x[0] - 3.0, 2);
    return rest - std::log(std::exp(left) / 3.0 + 2.0 * std::exp(right) / 3.0);
  };
  const GoldStandard gold =
      sampleGold(goldTarget(energy, 4.0), GoldOptions(), no_report);
  EXPECT_TRUE(gold.has_converged);
  Moments truth;
  truth.mean[0] = 1.0;
  truth.covariance = Matrix6d::Identity();
  truth.covariance(0, 0) = 9.0;
  expectMoments(gold.chains, truth);
}

TEST(GoldStandard, SaysWhenItHasNotConverged)
{
  GoldOptions options;
  options.steps_per_round = 100;
  options.max_seconds = 1e-9; // ends after the first round
  const GoldStandard gold =
      sampleGold(goldTarget(energyOf(exampleGaussian()), 5.0), options, no_report);
  EXPECT_FALSE(gold.has_converged);
  EXPECT_LT(gold.bulk_ess, options.min_ess);
}

// The energy jumps where nearest points change: Metropolis steps follow it, and Stein
// particles, whose gradients do not see the jumps, are too narrow besides.
TEST(GoldStandard, OfDistributionsIsWhatMetropolisStepsDraw)
{
  Random random(6, 0);
  const auto surface = [&](Eigen::Index num_points) {
    Eigen::Matrix3Xd points = test::randomPoints(random, num_points);
    for (auto point : points.colwise())
      point[2] = 0.1 * std::sin(9.0 * point[0]) * std::cos(8.0 * point[1]) +
                 0.003 * random.normal();
    return points;
  };
  const Scene scene{"waves", surface(150), KdTree(surface(2000).cast<float>())};
  const Problem problem(scene, {0.01, 100.0}, Residual::DistributionToDistribution);
  const GoldStandard gold = sampleGold(problem.goldTarget(), GoldOptions(), no_report);
  EXPECT_TRUE(gold.has_converged);
  PoseMatrix draws = pooled(gold.chains);
  for (Eigen::Index i = 0; i < draws.rows(); ++i)
    draws.row(i) = problem.energy().toTheta(draws.row(i).transpose()).transpose();
  const auto scoreOfSteps = [&](ExactSteps steps) {
    return scoreOf(runExact(problem, 1, 1, steps), draws);
  };
  const Score metropolis = scoreOfSteps(ExactSteps::Metropolis);
  EXPECT_EQ(metropolis.status, "ok");
  EXPECT_LT(metropolis.kl, 0.06);
  const Score stein = scoreOfSteps(ExactSteps::SteinNewton);
  EXPECT_EQ(stein.status, "not_mixed");
  EXPECT_GT(stein.kl, 0.2);
}

TEST(GoldStandard, DoesNotDependOnTheNumberOfThreads)
{
  GoldOptions options;
  options.steps_per_round = 200;
  options.max_kl = 1.0;
  options.max_rhat = 2.0;
  options.min_ess = 10.0;
  const GoldTarget target = goldTarget(energyOf(exampleGaussian()), 5.0);
  const GoldStandard one = sampleGold(target, options, no_report);
  options.num_threads = 2;
  const GoldStandard two = sampleGold(target, options, no_report);
  EXPECT_EQ(pooled(one.chains), pooled(two.chains));
}
