// The sampler on its own: steps against the paper's formulas, chains on a Gaussian, and
// how chains start, burn in, thin, stop and share threads. No point clouds.
#include "paper/paper.h"
#include "paper/sgld.h"

#include <bayesian_icp/diagnostics.h>

#include <gtest/gtest.h>

#include <omp.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>

namespace bayesian_icp {
namespace {

using namespace std::chrono_literals;

/** Gaussian with independent coordinates of the given precisions, mean 0. The
 * mini-batch mean is held constant, so the preconditioner becomes constant, too. */
SampledDensity
gaussianDensity(const Vector6d& precision, const Vector6d& mini_batch_mean)
{
  SampledDensity density;
  density.make_gradient = [=](int) {
    return [=](const Vector6d& pose, Random&) {
      return EnergyGradient{precision.cwiseProduct(pose), mini_batch_mean};
    };
  };
  density.has_diverged = [](const Vector6d& pose) {
    return pose.cwiseAbs().maxCoeff() > 1e3;
  };
  return density;
}

SampledDensity
unitGaussian()
{
  return gaussianDensity(Vector6d::Ones(), Vector6d::Ones());
}

PaperOptions
withSteps(double step_size)
{
  PaperOptions options;
  options.sgld.step_size = step_size;
  options.sgld.block_decay_factor = 1.0;
  return options;
}

ChainOptions
chainOptions(int num_chains, int num_draws)
{
  ChainOptions options;
  options.num_chains = num_chains;
  options.num_draws = num_draws;
  options.num_threads = 1;
  return options;
}

/** Chains that start at zero. */
ChainSet
run(const SampledDensity& density,
    const PaperOptions& options,
    const ChainOptions& chains,
    const ProgressCallback& progress = ProgressCallback())
{
  return runChains(Vector6d::Zero(), density, options, chains, progress);
}

TEST(Preconditioner, FollowsEquations10And11)
{
  SgldOptions options;
  options.decay_rate = 0.75;
  options.lambda_rms = 1e-3;
  RmsPropPreconditioner preconditioner(options);
  const Vector6d first(1, -2, 3, -4, 5, 0), second(-1, 1, 0, 2, 0.5, 0);
  preconditioner.update(first);
  const Vector6d A = preconditioner.update(second);
  for (int k = 0; k < 6; ++k) {
    const double V = 0.75 * (0.25 * first[k] * first[k]) + 0.25 * second[k] * second[k];
    EXPECT_NEAR(A[k], 1.0 / (1e-3 + std::sqrt(V)), 1e-12 * A[k]) << k;
  }
}

TEST(StepSize, DecaysInBlocksTowardsTheEnd)
{
  SgldOptions options;
  options.step_size = 1.0;
  EXPECT_EQ(stepSizeAt(options, 1899, 2000), 1.0);
  EXPECT_DOUBLE_EQ(stepSizeAt(options, 1900, 2000), 0.8);
  EXPECT_DOUBLE_EQ(stepSizeAt(options, 1909, 2000), 0.8);
  EXPECT_DOUBLE_EQ(stepSizeAt(options, 1910, 2000), 0.64);
  EXPECT_NEAR(stepSizeAt(options, 1999, 2000), std::pow(0.8, 10), 1e-15);
  options.block_decay_start = 0.0;
  EXPECT_DOUBLE_EQ(stepSizeAt(options, 0, 2000), 0.8);
}

TEST(SgldStep, WithoutNoiseIsTheDescentStepOfEquation5)
{
  Random random(1, 0);
  const Vector6d pose(1, 2, 3, 0.1, 0.2, 0.3), gradient(1, -1, 2, -2, 3, -3),
      A(1, 2, 3, 4, 5, 6);
  const Vector6d next = sgldStep(pose, gradient, A, 0.02, 0.0, random);
  EXPECT_LT((next - (pose - 0.01 * A.cwiseProduct(gradient))).norm(), 1e-15);
}

TEST(SgldStep, InjectsNoiseOfVarianceAlphaATimesItsFactor)
{
  Random random(2, 0);
  const Vector6d A(1, 2, 3, 4, 5, 6);
  const int n = 50000;
  for (const double factor : {1.0, 3.0}) {
    Vector6d sum_of_squares = Vector6d::Zero();
    for (int i = 0; i < n; ++i)
      sum_of_squares +=
          sgldStep(Vector6d::Zero(), Vector6d::Zero(), A, 0.02, factor, random)
              .cwiseAbs2();
    // The relative standard error of a variance is sqrt(2 / n); four of them.
    for (int k = 0; k < 6; ++k)
      EXPECT_NEAR(sum_of_squares[k] / n / (0.02 * factor * A[k]),
                  1.0,
                  4.0 * std::sqrt(2.0 / n));
  }
}

TEST(Chains, SampleAGaussianWithTheBiasOfTheStepSize)
{
  // theta' = (1 - alpha p / 2) theta + sqrt(alpha) xi has variance 1 / (p (1 - alpha
  // p/4)). The angles are so narrow that bringing them to canonical form changes none.
  const Vector6d precision(10.0, 20.0, 60.0, 40.0, 80.0, 100.0);
  const double alpha = 0.02;
  auto options = withSteps(alpha);
  options.num_burn_in = 500;
  const ChainSet set = run(
      gaussianDensity(precision, Vector6d::Ones()), options, chainOptions(4, 80000));
  for (int k = 0; k < 6; ++k) {
    Eigen::MatrixXd draws(20000, 4), squares(20000, 4);
    for (int c = 0; c < 4; ++c)
      draws.col(c) = set.chains[static_cast<std::size_t>(c)].draws.col(k);
    squares = draws.cwiseAbs2();
    const double variance = 1.0 / (precision[k] * (1.0 - alpha * precision[k] / 4.0));
    EXPECT_NEAR(draws.mean(), 0.0, 4.0 * mcseMean(draws)) << k;
    EXPECT_NEAR(squares.mean(), variance, 4.0 * mcseMean(squares)) << k;
  }
}

TEST(Chains, DependOnSeedAndChainOnly)
{
  auto options = chainOptions(2, 20);
  const auto draws = [&](std::uint64_t seed, std::size_t chain) {
    options.seed = seed;
    return run(unitGaussian(), withSteps(0.1), options).chains[chain].draws;
  };
  EXPECT_EQ(draws(1, 0), draws(1, 0));
  EXPECT_NE(draws(1, 0), draws(1, 1));
  EXPECT_NE(draws(1, 0), draws(2, 0));
}

TEST(Chains, BurnInAndThinningSelectFromTheSameChain)
{
  const auto draws = [](int num_draws, int num_burn_in, int thinning) {
    auto options = withSteps(0.1);
    options.num_burn_in = num_burn_in;
    options.thinning = thinning;
    return run(unitGaussian(), options, chainOptions(1, num_draws)).chains[0].draws;
  };
  const PoseMatrix all = draws(100, 0, 1);
  EXPECT_EQ(draws(90, 10, 1), all.bottomRows(90));
  const PoseMatrix thinned = draws(30, 10, 3);
  for (Eigen::Index i = 0; i < 30; ++i)
    EXPECT_EQ(thinned.row(i), all.row(10 + 3 * i + 2));
}

TEST(Chains, StartAtTheGuessPlusTheirSpread)
{
  const int num_chains = 4000;
  auto options = withSteps(0.1);
  const Vector6d start(1, -2, 3, 0.1, 0.2, -0.3);
  options.initial_spread << 0.5, 0.1, 0.2, 0.01, 0.02, 0.0;
  // A flat density and no noise: the first draw is the start.
  options.sgld.noise_factor = 0.0;
  const ChainSet set = runChains(start,
                                 gaussianDensity(Vector6d::Zero(), Vector6d::Ones()),
                                 options,
                                 chainOptions(num_chains, num_chains));
  Vector6d mean = Vector6d::Zero(), mean_square = Vector6d::Zero();
  for (const auto& chain : set.chains) {
    const Vector6d deviation = chain.draws.row(0).transpose() - start;
    mean += deviation / num_chains;
    mean_square += deviation.cwiseAbs2() / num_chains;
  }
  for (int k = 0; k < 6; ++k) {
    const double sd = options.initial_spread[k];
    EXPECT_NEAR(mean[k], 0.0, 4.0 * sd / std::sqrt(num_chains) + 1e-15);
    EXPECT_NEAR(mean_square[k], sd * sd, 4.0 * sd * sd * std::sqrt(2.0 / num_chains));
  }
}

TEST(Chains, KeepCanonicalPoses)
{
  Vector6d start = Vector6d::Zero();
  start[4] = 2.0; // beyond pi / 2
  start[5] = 10.0;
  auto options = withSteps(0.1);
  options.sgld.noise_factor = 0.0;
  const ChainSet set = runChains(start,
                                 gaussianDensity(Vector6d::Zero(), Vector6d::Ones()),
                                 options,
                                 chainOptions(1, 1));
  EXPECT_EQ(Vector6d(set.chains[0].draws.row(0).transpose()), canonicalPose(start));
}

TEST(Chains, ThatRunAwayAreStoppedAndMarked)
{
  // Precision 100 with step 0.1 is unstable; chain 1 alone gets it.
  auto density = unitGaussian();
  density.make_gradient = [](int chain) {
    return [chain](const Vector6d& pose, Random&) {
      return EnergyGradient{(chain == 1 ? 100.0 : 1.0) * pose, Vector6d::Ones()};
    };
  };
  const ChainSet set =
      runChains(Vector6d::Ones(), density, withSteps(0.1), chainOptions(3, 300));
  EXPECT_FALSE(set.chains[0].diverged);
  EXPECT_TRUE(set.chains[1].diverged);
  EXPECT_FALSE(set.chains[2].diverged);
  EXPECT_LT(set.chains[1].draws.rows(), 100);
  EXPECT_TRUE(set.chains[1].draws.allFinite());
  EXPECT_EQ(set.chains[2].draws.rows(), 100);
}

TEST(Chains, ThatAreWhiteNoiseOnTheCircleAreMarked)
{
  // Without a gradient V is 0 and A is 1e8: every step turns the angles many times.
  // R-hat and effective sample size of such draws are perfect.
  auto density = gaussianDensity(Vector6d::Zero(), Vector6d::Zero());
  density.has_diverged = [](const Vector6d&) { return false; };
  const ChainSet set = run(density, withSteps(1e-4), chainOptions(2, 200));
  EXPECT_TRUE(set.chains[0].diverged);
  EXPECT_TRUE(set.chains[1].diverged);
}

TEST(Chains, ThatBecomeNonFiniteAreStoppedAndMarked)
{
  auto density = unitGaussian();
  density.make_gradient = [](int) {
    return [](const Vector6d&, Random&) {
      return EnergyGradient{
          Vector6d::Constant(std::numeric_limits<double>::quiet_NaN()),
          Vector6d::Ones()};
    };
  };
  const ChainSet set = run(density, withSteps(0.1), chainOptions(1, 10));
  EXPECT_TRUE(set.chains[0].diverged);
  EXPECT_EQ(set.chains[0].draws.rows(), 0);
}

TEST(Progress, IsToldOfEveryStepOfEveryChainAndThePoseThatIsKept)
{
  auto options = withSteps(0.1);
  options.num_burn_in = 5;
  options.thinning = 2;
  auto chains = chainOptions(3, 30);
  chains.num_threads = 2;
  long calls = 0, last_total = 0;
  std::vector<std::vector<Vector6d>> kept(3);
  const auto set = run(unitGaussian(), options, chains, [&](const Progress& progress) {
    EXPECT_EQ(progress.steps, ++calls);
    last_total = progress.total_steps;
    const long sampled = progress.chain_steps - 5;
    if (sampled > 0 && sampled % 2 == 0)
      kept[static_cast<std::size_t>(progress.chain)].push_back(progress.pose);
    return true;
  });
  EXPECT_EQ(calls, 3 * (5 + 2 * 10));
  EXPECT_EQ(last_total, calls);
  for (std::size_t chain = 0; chain < 3; ++chain) {
    ASSERT_EQ(kept[chain].size(), 10U);
    for (std::size_t i = 0; i < 10; ++i)
      EXPECT_EQ(kept[chain][i],
                set.chains[chain].draws.row(static_cast<Eigen::Index>(i)).transpose());
  }
}

TEST(Progress, CanCancelAndWhatWasDrawnStays)
{
  for (const int num_threads : {1, 2}) {
    auto options = chainOptions(2, 2000);
    options.num_threads = num_threads;
    const auto stop = [](const Progress& p) { return p.steps < 100; };
    const ChainSet set = run(unitGaussian(), withSteps(0.1), options, stop);
    EXPECT_TRUE(set.cancelled);
    const auto num_draws = set.chains[0].draws.rows() + set.chains[1].draws.rows();
    EXPECT_GE(num_draws, 100);
    EXPECT_LT(num_draws, 110);
  }
}

TEST(Progress, AnExceptionReachesTheCaller)
{
  for (const int num_threads : {1, 2}) {
    auto options = chainOptions(4, 4000);
    options.num_threads = num_threads;
    const auto fail = [](const Progress& p) -> bool {
      if (p.steps == 50)
        throw std::runtime_error("enough");
      return true;
    };
    EXPECT_THROW(run(unitGaussian(), withSteps(0.1), options, fail),
                 std::runtime_error);
  }
}

TEST(Threads, AThrowingGradientReachesTheCaller)
{
  auto density = unitGaussian();
  density.make_gradient = [](int) {
    return [](const Vector6d&, Random&) -> EnergyGradient {
      throw std::runtime_error("broken search");
    };
  };
  auto options = chainOptions(4, 40);
  options.num_threads = 2;
  EXPECT_THROW(run(density, withSteps(0.1), options), std::runtime_error);
}

/** Most gradients that were being evaluated at one time. Each waits for another one,
 * until there were two or \p patience is over. */
int
largestConcurrency(bool is_thread_safe,
                   int num_threads,
                   std::chrono::milliseconds patience)
{
  const auto deadline = std::chrono::steady_clock::now() + patience;
  std::atomic<int> running{0}, largest{0};
  SampledDensity density = unitGaussian();
  density.is_thread_safe = is_thread_safe;
  density.make_gradient = [&](int) {
    return [&](const Vector6d& pose, Random&) {
      const int now = ++running;
      int seen = largest;
      while (now > seen && !largest.compare_exchange_weak(seen, now)) {
      }
      while (largest < 2 && std::chrono::steady_clock::now() < deadline)
        std::this_thread::yield();
      --running;
      return EnergyGradient{pose, Vector6d::Ones()};
    };
  };
  auto options = chainOptions(4, 4000);
  options.num_threads = num_threads;
  run(density, withSteps(0.1), options);
  return largest;
}

TEST(Threads, AreUsedAndLimitedToOneForAnUnsafeGradient)
{
  EXPECT_EQ(largestConcurrency(true, 1, 100ms), 1);
  EXPECT_EQ(largestConcurrency(true, 2, 60s), 2);
  EXPECT_EQ(largestConcurrency(false, 4, 100ms), 1);
}

TEST(Threads, InsideACallersParallelRegionTheRunIsSerial)
{
  int largest[2] = {0, 0};
#pragma omp parallel for num_threads(2)
  for (int i = 0; i < 2; ++i)
    largest[i] = largestConcurrency(true, 4, 100ms);
  EXPECT_EQ(largest[0], 1);
  EXPECT_EQ(largest[1], 1);
}

} // namespace
} // namespace bayesian_icp
