// Likelihood, prior and mini-batches: gradients against finite differences, scales, and
// the stochastic gradient they add up to.
#include "paper/likelihood.h"
#include "paper/paper.h"
#include "sampler/mini_batch.h"
#include "support/test_support.h"

#include <bayesian_icp/prior.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace bayesian_icp {
namespace {

Correspondences
randomCorrespondences(Random& random, Eigen::Index num_points)
{
  // Every third point has no correspondence, as if it were beyond the gate.
  const Eigen::Matrix3Xd targets = test::randomPoints(random, num_points);
  Correspondences correspondences;
  for (Eigen::Index i = 0; i < num_points; ++i)
    if (i % 3 != 2)
      correspondences.push_back({static_cast<std::size_t>(i), targets.col(i)});
  return correspondences;
}

Vector6d
gradientOf(const Vector6d& pose,
           const Eigen::Matrix3Xd& points,
           const Correspondences& correspondences)
{
  return meanGradient(pose, points, test::moved(pose, points), correspondences);
}

TEST(Likelihood, GradientMatchesCentralDifferences)
{
  Random random(11, 0);
  for (int i = 0; i < 20; ++i) {
    const Vector6d pose = test::randomPose(random);
    const Eigen::Matrix3Xd points =
        test::randomPoints(random, 30, Eigen::Vector3d(0.5, -1.0, 2.0));
    const Correspondences correspondences = randomCorrespondences(random, 30);
    const Vector6d numeric = test::centralDifferences(
        [&](const Vector6d& p) { return meanEnergy(p, points, correspondences); },
        pose);
    const Vector6d analytic = gradientOf(pose, points, correspondences);
    EXPECT_LT((analytic - numeric).norm(), 1e-8 * (1.0 + analytic.norm()));
  }
}

TEST(Likelihood, PointsWithoutCorrespondenceCountAsZeroInTheMean)
{
  Random random(12, 0);
  const Vector6d pose = test::randomPose(random);
  const Eigen::Matrix3Xd points = test::randomPoints(random, 10);
  Eigen::Matrix3Xd with_gated(3, 40);
  with_gated << points, test::randomPoints(random, 30);
  Correspondences all;
  for (std::size_t i = 0; i < 10; ++i)
    all.push_back({i, Eigen::Vector3d(0.1, 0.2, 0.3)});
  const Vector6d among_ten = gradientOf(pose, points, all);
  const Vector6d among_forty = gradientOf(pose, with_gated, all);
  EXPECT_LT((among_forty - among_ten / 4.0).norm(), 1e-13 * among_ten.norm());
}

TEST(Likelihood, WeightIsEffectivePointsOverSquaredSigma)
{
  LikelihoodScale options;
  EXPECT_DOUBLE_EQ(options.weight(), 6000.0);
  options.effective_points = 50.0;
  options.measurement_sigma = 0.01;
  EXPECT_DOUBLE_EQ(options.weight(), 5e5);
}

TEST(PriorGradient, MatchesCentralDifferencesInBothFrames)
{
  Random random(14, 0);
  const Vector6d variance(0.125, 0.01, 2.0, 0.1, 0.5, 0.02);
  for (const auto& reference :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1.0, -2.0, 3.0)})
    for (int i = 0; i < 10; ++i) {
      const Prior prior(test::randomPose(random), variance, reference);
      const Vector6d pose = test::randomPose(random);
      const Vector6d numeric = test::centralDifferences(
          [&](const Vector6d& p) { return prior.energy(p); }, pose);
      const Vector6d analytic = prior.energyGradient(pose);
      EXPECT_LT((analytic - numeric).norm(), 1e-7 * (1.0 + analytic.norm()));
    }
}

TEST(PriorGradient, AtTheOriginIsThePapersGaussianAndVonMises)
{
  Random random(15, 0);
  const Vector6d mean = test::randomPose(random);
  const Vector6d pose = test::randomPose(random);
  const Vector6d gradient = Prior(mean, Vector6d::Constant(0.125)).energyGradient(pose);
  for (int k = 0; k < 6; ++k) {
    const double d = pose[k] - mean[k];
    EXPECT_NEAR(gradient[k], 8.0 * (k < 3 ? d : std::sin(d)), 1e-12) << k; // (6), (7)
  }
}

TEST(PriorGradient, AboutTheCentroidATurnAboutItIsNotATranslation)
{
  const Eigen::Vector3d centroid(0.0, 0.0, 10.0);
  Vector6d turned = Vector6d::Zero();
  turned[3] = 0.1;
  turned.head<3>() = centroid - rotationOf(turned) * centroid;
  const Vector6d variance = Vector6d::Constant(0.125);
  const Vector6d mean = Vector6d::Zero();
  EXPECT_LT(Prior(mean, variance, centroid).deviation(turned).head<3>().norm(), 1e-14);
  EXPECT_GT(Prior(mean, variance).deviation(turned).head<3>().norm(), 0.9);
}

TEST(PriorGradient, InfiniteVarianceIsNoPrior)
{
  const double infinity = std::numeric_limits<double>::infinity();
  const Prior prior(Vector6d::Zero(), Vector6d::Constant(infinity));
  EXPECT_EQ(prior.energyGradient(Vector6d::Constant(0.3)), Vector6d(Vector6d::Zero()));
}

TEST(MiniBatch, WithReplacementEveryPointIsEquallyLikely)
{
  const std::size_t n = 20;
  MiniBatches batches(n, 10, MiniBatchSampling::WithReplacement);
  Random random(16, 0);
  std::vector<double> counts(n, 0.0);
  const int num_batches = 2000;
  for (int i = 0; i < num_batches; ++i)
    for (const auto index : batches.next(random))
      counts.at(index) += 1.0;
  const double expected = num_batches * 10.0 / n;
  double chi_squared = 0.0;
  for (const double count : counts)
    chi_squared += (count - expected) * (count - expected) / expected;
  EXPECT_LT(chi_squared, 43.82); // 99.9 % quantile of chi-squared with 19 degrees
}

TEST(MiniBatch, ShuffledEpochsUseEveryPointOnceAnEpoch)
{
  MiniBatches batches(12, 4, MiniBatchSampling::ShuffledEpochs);
  Random random(17, 0);
  std::vector<std::vector<std::size_t>> orders;
  for (int epoch = 0; epoch < 3; ++epoch) {
    std::vector<std::size_t> order;
    for (int i = 0; i < 3; ++i)
      for (const auto index : batches.next(random))
        order.push_back(index);
    EXPECT_EQ(std::set<std::size_t>(order.begin(), order.end()).size(), 12u);
    orders.push_back(order);
  }
  EXPECT_NE(orders[0], orders[1]);
  EXPECT_NE(orders[1], orders[2]);
}

TEST(MiniBatch, ABatchNeverRepeatsAPointWithoutReplacement)
{
  MiniBatches batches(10, 4, MiniBatchSampling::ShuffledEpochs); // 4 does not divide 10
  Random random(18, 0);
  for (int i = 0; i < 100; ++i) {
    const auto& batch = batches.next(random);
    EXPECT_EQ(std::set<std::size_t>(batch.begin(), batch.end()).size(), 4u);
  }
}

TEST(MiniBatch, SubsetsHoldEveryPointAsOftenAndNoneTwice)
{
  MiniBatches batches({10, 11, 12, 13, 14, 15, 16, 17});
  Random random(20, 0), untouched = random;
  EXPECT_EQ(batches.subset(8, random).size(), 8u);
  EXPECT_EQ(random.uniform(), untouched.uniform()); // there is but one way to take all
  std::vector<double> counts(8, 0.0);
  constexpr int num_subsets = 2000, size = 3;
  for (int i = 0; i < num_subsets; ++i) {
    const auto& subset = batches.subset(size, random);
    EXPECT_EQ(std::set<std::size_t>(subset.begin(), subset.end()).size(), 3u);
    for (const auto point : subset)
      counts.at(point - 10) += 1.0;
  }
  // Binomial each: five standard deviations.
  constexpr double share = size / 8.0;
  for (const double count : counts)
    EXPECT_NEAR(count,
                num_subsets * share,
                5.0 * std::sqrt(num_subsets * share * (1.0 - share)));
}

TEST(MiniBatch, IsNeverLargerThanTheSource)
{
  MiniBatches batches(5, 160, MiniBatchSampling::WithReplacement);
  Random random(19, 0);
  EXPECT_EQ(batches.next(random).size(), 5u);
}

TEST(StochasticGradient, MeanOverAPartitionIsTheFullGradient)
{
  // Forces the scale N / m with gated points counted as zero.
  for (const double gate : {std::numeric_limits<double>::infinity(), 0.1}) {
    Random random(20, 0);
    const Eigen::Matrix3Xd source = test::randomPoints(random, 60);
    const test::BruteForceSearch search(test::randomPoints(random, 50), gate);
    const Prior prior(Vector6d::Zero(), Vector6d::Constant(0.125));
    const Vector6d pose = test::randomPose(random, 0.1) * 0.05;
    const auto meanOverEpoch = [&](std::size_t batch_size) {
      const MiniBatches batches(60, batch_size, MiniBatchSampling::ShuffledEpochs);
      auto gradient = posteriorGradient(source, search, prior, 6000.0, batches);
      Vector6d sum = Vector6d::Zero();
      for (std::size_t i = 0; i < 60 / batch_size; ++i)
        sum += gradient(pose, random).energy;
      return Vector6d(sum * static_cast<double>(batch_size) / 60.0);
    };
    const Vector6d full = meanOverEpoch(60);
    ASSERT_GT(full.norm(), 1.0);
    for (const std::size_t batch_size : {1, 5, 12, 30})
      EXPECT_LT((meanOverEpoch(batch_size) - full).norm(), 1e-11 * full.norm()) << gate;
  }
}

TEST(PosteriorGradientScale, IsWeightTimesMeanGradientPlusPrior)
{
  Random random(21, 0);
  const Eigen::Matrix3Xd source = test::randomPoints(random, 40);
  const test::BruteForceSearch search(test::randomPoints(random, 50));
  const Prior prior(test::randomPose(random), Vector6d::Constant(0.01));
  const MiniBatches batches(40, 8, MiniBatchSampling::WithReplacement);
  const Vector6d pose = test::randomPose(random);
  const EnergyGradient gradient =
      posteriorGradient(source, search, prior, 123.0, batches)(pose, random);
  EXPECT_LT(
      (gradient.energy - 123.0 * gradient.mini_batch_mean - prior.energyGradient(pose))
          .norm(),
      1e-12 * gradient.energy.norm());
}

TEST(RandomNumbers, StreamsAreIndependentAndRepeatable)
{
  Random a(5, 0), again(5, 0), other_stream(5, 1), other_seed(6, 0);
  const double first = a.normal();
  EXPECT_EQ(first, again.normal());
  EXPECT_NE(first, other_stream.normal());
  EXPECT_NE(first, other_seed.normal());
}

TEST(RandomNumbers, NormalsHaveTheMomentsOfTheNormalDistribution)
{
  Random random(22, 0);
  const int n = 200000;
  double moments[5] = {};
  for (int i = 0; i < n; ++i) {
    const double z = random.normal();
    for (int k = 1; k <= 4; ++k)
      moments[k] += std::pow(z, k) / n;
  }
  const double four_errors = 4.0 / std::sqrt(static_cast<double>(n));
  EXPECT_NEAR(moments[1], 0.0, four_errors * 1.0);
  EXPECT_NEAR(moments[2], 1.0, four_errors * std::sqrt(2.0));
  EXPECT_NEAR(moments[3], 0.0, four_errors * std::sqrt(15.0));
  EXPECT_NEAR(moments[4], 3.0, four_errors * std::sqrt(96.0));
}

} // namespace
} // namespace bayesian_icp
