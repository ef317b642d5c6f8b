// The evaluation app's own pieces: distances against closed forms, scores of good and
// bad draws, and the gold standard, Metropolis runs on densities whose moments are
// known.
#include "samplers/score.h"
#include "study/draw_statistics.h"
#include "support/test_support.h"

#include <bayesian_icp/diagnostics.h>

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include <cmath>
#include <utility>

using namespace bayesian_icp;
using namespace bayesian_icp::evaluate;

namespace {

/** A correlated Gaussian whose standard deviations differ by 1000. */
Moments
exampleGaussian()
{
  Moments gaussian;
  gaussian.mean << 0.1, -0.2, 0.3, 0.5, -1.0, 2.0;
  Matrix6d factor = Matrix6d::Identity();
  factor(5, 0) = 0.9;
  factor(3, 1) = -0.7;
  Vector6d scale;
  scale << 0.001, 0.01, 0.1, 1.0, 0.02, 0.5;
  factor = scale.asDiagonal() * factor;
  gaussian.covariance = factor * factor.transpose();
  return gaussian;
}

PoseMatrix
gaussianDraws(const Moments& gaussian, Eigen::Index num_draws, std::uint64_t seed)
{
  const Matrix6d factor = gaussian.covariance.llt().matrixL();
  Random random(seed, 0);
  PoseMatrix draws(num_draws, 6);
  for (Eigen::Index i = 0; i < num_draws; ++i)
    draws.row(i) = (gaussian.mean + factor * random.normal6()).transpose();
  return draws;
}

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
  const auto expectDistance = [](const Eigen::VectorXd& a,
                                 const Eigen::VectorXd& b,
                                 double wasserstein,
                                 double kolmogorov_smirnov) {
    const SampleDistance distance = distanceBetween(a, b);
    EXPECT_NEAR(distance.wasserstein, wasserstein, 1e-12);
    EXPECT_NEAR(distance.kolmogorov_smirnov, kolmogorov_smirnov, 1e-12);
  };
  const Eigen::VectorXd a = Eigen::VectorXd::LinSpaced(5, 0.0, 4.0);
  expectDistance(a, a.array() + 0.25, 0.25, 0.2);
  expectDistance(a, a, 0.0, 0.0);
  // A point at 0 against half at 0, half at 1; of different sizes and unsorted.
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  const Eigen::Vector4d halves(1.0, 0.0, 1.0, 0.0);
  expectDistance(zero, halves, 0.5, 0.5);
  expectDistance(halves, zero, 0.5, 0.5);
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
  SamplerRun particles; // as few as Stein steps take
  particles.chains.chains.resize(1);
  particles.chains.chains[0].draws = gaussianDraws(gaussian, min_particles, 2);
  EXPECT_TRUE(std::isfinite(scoreOf(particles, gold).kl));
}

TEST(Score, TheSummaryHasMediansAndWorstCases)
{
  std::vector<ScoredRun> runs(4);
  const double kl[] = {0.1, 0.3, 0.2}, bulk_ess[] = {400.0, 100.0, 300.0};
  const double tail_ess[] = {500.0, 50.0, 200.0}, seconds[] = {2.0, 1.0, 3.0};
  for (std::size_t i = 0; i < 3; ++i) {
    runs[i].name = {"can", 0.005, 300.0, "exact", i, "key"};
    Score& score = runs[i].score;
    score.kl = kl[i];
    score.wasserstein[i] = 2.0 * kl[i];
    score.rhat = 1.0 + kl[i];
    score.bulk_ess = bulk_ess[i];
    score.tail_ess = tail_ess[i];
    score.seconds = seconds[i];
    score.status = i == 0 ? "not_converged" : "ok";
  }
  // Six, three and none of the marginals are right: half of them.
  runs[1].score.kolmogorov_smirnov.head<3>().setConstant(0.06);
  runs[2].score.kolmogorov_smirnov.setOnes();
  runs[3].name = {"can", 0.005, 300.0, "walk", 1, "key"};
  runs[3].score = scoreOf(SamplerRun(), gaussianDraws(exampleGaussian(), 100, 1));
  runs[3].score.seconds = 0.5;
  EXPECT_EQ(summaryOf(runs),
            "  runs of                           runs  KL, median  worst   W1  KS < .06"
            "  R-hat, worst  bulk ESS, least  tail ESS  ESS/s  CPU [s]   mixed\n"
            "  can, sigma 0.005 m, N 300, exact     3         0.2    0.3  0.4       0.5"
            "           1.3              100        50    100        2  0.6667\n"
            "  can, sigma 0.005 m, N 300, walk      1         inf    inf  inf         0"
            "           inf                0         0      0      0.5       0\n");
}

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

/** Two samples of a wavy surface. */
Scene
waves()
{
  Random random(6, 0);
  const auto surface = [&](Eigen::Index num_points) {
    Eigen::Matrix3Xd points = test::randomPoints(random, num_points);
    for (auto point : points.colwise())
      point[2] = 0.1 * std::sin(9.0 * point[0]) * std::cos(8.0 * point[1]) +
                 0.003 * random.normal();
    return points;
  };
  Eigen::Matrix3Xd source = surface(150);
  return {"waves", std::move(source), KdTree(surface(2000).cast<float>())};
}

TEST(SamplerProblem, HasTheGradientOfItsEnergy)
{
  const Scene scene = waves();
  const Problem problem(scene, {0.2, 1.0}); // points count as much as the prior
  const GradientFunction energy = problem.makeGradient();
  Random random(8, 0);
  const Vector6d phi = 0.05 * random.normal6();
  const auto valueOf = [&](const Vector6d& at) {
    Vector6d unused;
    return energy(at, unused);
  };
  Vector6d gradient;
  energy(phi, gradient);
  const double of_prior = problem.energy().priorGradient(phi).norm();
  EXPECT_GT(of_prior, 0.3 * gradient.norm());
  // Squared distances are floats: the error is 1e-7 of the energy, over the step.
  const Vector6d differences = test::centralDifferences(valueOf, phi, 1e-4);
  EXPECT_LT((gradient - differences).norm(), 0.01 * of_prior);
}

// The energy jumps where nearest points change: Metropolis steps follow it, and Stein
// particles, whose gradients do not see the jumps, are too narrow besides.
TEST(GoldStandard, OfDistributionsIsWhatMetropolisStepsDraw)
{
  const Scene scene = waves();
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
