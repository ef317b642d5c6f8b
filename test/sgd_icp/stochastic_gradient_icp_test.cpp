// SGD-ICP: its fixed point, its noise, its rules of convergence, its filter, its
// failures.
#include "paper/matched_batch.h"
#include "support/test_support.h"

#include <bayesian_icp/stochastic_gradient_icp.h>

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <vector>

namespace bayesian_icp {
namespace {

constexpr SgdOptimizer all_optimizers[] = {SgdOptimizer::FixedStep,
                                           SgdOptimizer::Momentum,
                                           SgdOptimizer::AdaDelta,
                                           SgdOptimizer::Adam,
                                           SgdOptimizer::RmsProp};

/** Knows the partner of every source point, and counts how often it is asked. */
class KnownPairs : public CorrespondenceSearch {
public:
  explicit KnownPairs(Eigen::Matrix3Xd partners) : partners_(std::move(partners)) {}

  void
  find(const Vector6d& /* pose */,
       const std::vector<std::size_t>& source_indices,
       const Eigen::Matrix3Xd& /* moved_points */,
       Correspondences& correspondences) const override
  {
    ++num_calls;
    correspondences.clear();
    if (num_calls <= num_empty_calls)
      return;
    for (std::size_t i = 0; i < source_indices.size(); ++i)
      correspondences.push_back(
          {i, partners_.col(static_cast<Eigen::Index>(source_indices[i]))});
  }

  bool
  isThreadSafe() const override
  {
    return false;
  }

  mutable int num_calls = 0;
  int num_empty_calls = 0;

private:
  Eigen::Matrix3Xd partners_;
};

/** ICP by brute force, until the pairs stay the same: Umeyama's closed form. */
Vector6d
icpFixedPoint(const Eigen::Matrix3Xd& source,
              const Eigen::Matrix3Xd& target,
              Vector6d pose)
{
  const test::BruteForceSearch search(target);
  Vector6d last = Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
  for (int i = 0; i < 100 && pose != last; ++i) {
    last = pose;
    Eigen::Matrix3Xd moved, partners(3, source.cols());
    movePoints(pose, source, moved);
    Correspondences pairs;
    search.find(pose, {}, moved, pairs);
    for (const auto& pair : pairs)
      partners.col(static_cast<Eigen::Index>(pair.source_index)) = pair.target_point;
    pose = poseOf(Eigen::umeyama(source, partners, false));
  }
  EXPECT_EQ(pose, last);
  return pose;
}

struct NoisyPair {
  Eigen::Matrix3Xd source, target;
  Vector6d truth = 0.02 * Vector6d::Ones();

  /** Points in a box of 3 m about the origin: curvatures are of order one. They are
   * further apart than the clouds are, so that all descents find the same pairs. */
  explicit NoisyPair(double noise, Eigen::Index num_points = 60)
  {
    Random random(5, 0);
    source = 3.0 * test::randomPoints(random, num_points);
    movePoints(truth, source, target);
    for (Eigen::Index i = 0; i < target.size(); ++i)
      target(i % 3, i / 3) += noise * random.normal();
  }
};

TEST(StochasticGradientIcp, FullBatchesReachTheFixedPointOfIcp)
{
  const NoisyPair pair(0.02);
  const test::BruteForceSearch search(pair.target);
  const Vector6d expected = icpFixedPoint(pair.source, pair.target, Vector6d::Zero());
  EXPECT_GT((expected - pair.truth).norm(), 1e-4); // noise moved it
  for (const SgdOptimizer optimizer : all_optimizers) {
    if (optimizer == SgdOptimizer::Adam) // its steps need not shrink
      continue;
    StochasticGradientIcpOptions options;
    options.optimizer = optimizer;
    options.batch_size = 1000;
    options.is_one_to_one = false;
    options.max_iterations = 4000;
    // The slowest, RMSProp, ends up with steps of 0.01 / sqrt(1e-3) = 0.3 times the
    // gradient and a least curvature of 0.3 m^2, which takes 9 % off the error in every
    // step: a thousand still ones leave rounding.
    options.translation_epsilon = options.rotation_epsilon = 1e-8;
    options.num_still_iterations = 1000;
    const auto result =
        stochasticGradientIcp(pair.source, search, Vector6d::Zero(), options);
    EXPECT_TRUE(result.has_converged) << toString(optimizer);
    EXPECT_LT((result.pose - expected).norm(), 1e-12) << toString(optimizer);
  }
}

TEST(StochasticGradientIcp, TheMeanIsThatOfThePairsNotOfTheBatch)
{
  // Half of the points are without a partner; one step of size 1 then moves the rest
  // all the way.
  Random random(6, 0);
  Eigen::Matrix3Xd source = test::randomPoints(random, 40);
  Eigen::Matrix3Xd target = source.leftCols(20).colwise() + Eigen::Vector3d::UnitX();
  source.rightCols(20).array() += 100.0;
  const test::BruteForceSearch search(target, 2.0);
  StochasticGradientIcpOptions options;
  options.optimizer = SgdOptimizer::FixedStep;
  options.batch_size = 40;
  options.max_iterations = 1;
  options.is_one_to_one = false;
  const auto result =
      stochasticGradientIcp(source,
                            KnownPairs(source.colwise() + Eigen::Vector3d::UnitX()),
                            Vector6d::Zero(),
                            options);
  EXPECT_NEAR(result.pose.x(), 1.0, 1e-12);
  const auto gated =
      stochasticGradientIcp(source, search, 0.999 * Vector6d::Unit(0), options);
  EXPECT_NEAR(gated.pose.x(), 1.0, 1e-12);
}

TEST(StochasticGradientIcp, MiniBatchesScatterAboutTheFixedPointAsTheoryHasIt)
{
  // With known pairs and fixed step h every translation is x <- x - h (x - mean of m
  // residuals): a first-order autoregression of variance h / (2 - h) s^2 / m. Of the
  // 2000 points 20 are taken without replacement, which is 1 % less; 900 values have a
  // relative standard error of 4.7 %.
  const double noise = 0.02, h = 0.5;
  const int batch_size = 20, num_runs = 300;
  NoisyPair pair(noise, 2000);
  pair.source.colwise() -= pair.source.rowwise().mean().eval();
  const KnownPairs search(pair.target);
  const Vector6d centre = poseOf(Eigen::umeyama(pair.source, pair.target, false));
  StochasticGradientIcpOptions options;
  options.optimizer = SgdOptimizer::FixedStep;
  options.step_size = h;
  options.batch_size = batch_size;
  options.max_iterations = 60;
  options.translation_epsilon = 0.0; // never at rest
  double sum = 0.0;
  for (int run = 0; run < num_runs; ++run) {
    options.seed = static_cast<std::uint64_t>(run);
    const auto result = stochasticGradientIcp(pair.source, search, centre, options);
    EXPECT_EQ(result.end, DescentEnd::MaxIterations);
    sum += (result.pose - centre).head<3>().squaredNorm();
  }
  const double expected = h / (2.0 - h) * noise * noise / batch_size;
  EXPECT_NEAR(sum / (3.0 * num_runs) / expected, 0.99, 4.0 * 0.047);
}

/** When a pose is at rest, said otherwise than in the library: the first step t from
 * which on num_still positions are near the last one that was not near its own. */
int
stepOfRest(const std::vector<double>& positions, double epsilon, int num_still)
{
  std::size_t anchor = 0;
  for (std::size_t t = 1; t < positions.size(); ++t) {
    if (std::abs(positions[t] - positions[anchor]) >= epsilon)
      anchor = t;
    if (t - anchor == static_cast<std::size_t>(num_still))
      return static_cast<int>(t);
  }
  return -1;
}

TEST(StochasticGradientIcp, StopsAfterTheGivenNumberOfStillSteps)
{
  Random random(7, 0);
  const Eigen::Matrix3Xd source = test::randomPoints(random, 30);
  const KnownPairs search(source.colwise() + 0.4 * Eigen::Vector3d::UnitY());
  StochasticGradientIcpOptions options;
  options.optimizer = SgdOptimizer::FixedStep;
  options.step_size = 0.05;
  options.rotation_epsilon = 100.0;
  for (const double epsilon : {0.05, 0.005})
    for (const int num_still : {1, 3, 20}) {
      std::vector<double> positions(1000);
      for (std::size_t t = 0; t < positions.size(); ++t)
        positions[t] = 0.4 * (1.0 - std::pow(0.95, t));
      options.translation_epsilon = epsilon;
      options.num_still_iterations = num_still;
      const auto result =
          stochasticGradientIcp(source, search, Vector6d::Zero(), options);
      EXPECT_EQ(result.num_iterations, stepOfRest(positions, epsilon, num_still));
      EXPECT_TRUE(result.has_converged);
    }
  options.translation_epsilon = 100.0;
  options.rotation_epsilon = 0.0;
  EXPECT_EQ(stochasticGradientIcp(source, search, Vector6d::Zero(), options).end,
            DescentEnd::MaxIterations);
}

TEST(StochasticGradientIcp, AnglesAreStillWhereTheirSumIsWrapped)
{
  // A turn about z near half a turn: the angle runs past pi without a jump being seen.
  Random random(8, 0);
  const Eigen::Matrix3Xd source = 2.0 * test::randomPoints(random, 200);
  Vector6d truth = Vector6d::Zero(), start = Vector6d::Zero();
  truth[5] = -3.1;
  start[5] = 3.1;
  Eigen::Matrix3Xd partners;
  movePoints(truth, source, partners);
  StochasticGradientIcpOptions options;
  options.optimizer = SgdOptimizer::FixedStep;
  options.batch_size = 200;
  options.translation_epsilon = options.rotation_epsilon = 1e-9;
  options.max_iterations = 1000;
  const auto result =
      stochasticGradientIcp(source, KnownPairs(partners), start, options);
  EXPECT_TRUE(result.has_converged);
  EXPECT_NEAR(result.pose[5], -3.1, 1e-6);
}

TEST(MatchedBatch, OneToOneKeepsTheNearestOfEachTargetPoint)
{
  Random random(9, 0);
  const Eigen::Matrix3Xd source = test::randomPoints(random, 200);
  const Eigen::Matrix3Xd target = test::randomPoints(random, 15);
  const test::BruteForceSearch search(target);
  const Vector6d pose = test::randomPose(random, 0.1);
  Eigen::Matrix3Xd moved;
  movePoints(pose, source, moved);
  Correspondences all;
  search.find(pose, {}, moved, all);
  // By brute force: no other pair of the same target point is nearer.
  Vector6d sum = Vector6d::Zero();
  std::size_t num_kept = 0;
  for (const auto& pair : all) {
    bool is_nearest = true;
    for (const auto& other : all)
      is_nearest &=
          other.target_point != pair.target_point ||
          (moved.col(static_cast<Eigen::Index>(other.source_index)) -
           other.target_point)
                  .norm() >= (moved.col(static_cast<Eigen::Index>(pair.source_index)) -
                              pair.target_point)
                                 .norm();
    if (is_nearest) {
      sum += meanGradient(pose, source, moved, {pair});
      ++num_kept;
    }
  }
  ASSERT_LT(num_kept, all.size());

  MatchedBatch batch(
      source, search, MiniBatches(200, 200, MiniBatchSampling::ShuffledEpochs));
  batch.draw(pose, random);
  EXPECT_EQ(batch.numMatched(), all.size());
  batch.makeOneToOne();
  EXPECT_EQ(batch.numMatched(), num_kept);
  EXPECT_LT((batch.meanGradient() - sum).norm(), 1e-13);
  batch.makeOneToOne();
  EXPECT_EQ(batch.numMatched(), num_kept);
}

TEST(MatchedBatch, OneToOneKeepsOneOfEquallyNearPoints)
{
  const Eigen::Matrix3Xd source = Eigen::Matrix3Xd::Zero(3, 10);
  const KnownPairs search(Eigen::Matrix3Xd::Ones(3, 10));
  Random random(10, 0);
  MatchedBatch batch(
      source, search, MiniBatches(10, 10, MiniBatchSampling::ShuffledEpochs));
  batch.draw(Vector6d::Zero(), random);
  batch.makeOneToOne();
  EXPECT_EQ(batch.numMatched(), 1u);
}

TEST(StochasticGradientIcp, TheFilterIsUsedWhereAskedFor)
{
  // All points have the one target point: filtered, a single pair is left.
  Random random(11, 0);
  const Eigen::Matrix3Xd source = test::randomPoints(random, 30);
  const KnownPairs search(Eigen::Matrix3Xd::Zero(3, 30));
  StochasticGradientIcpOptions options;
  options.optimizer = SgdOptimizer::FixedStep;
  EXPECT_EQ(stochasticGradientIcp(source, search, Vector6d::Ones(), options).end,
            DescentEnd::TooFewCorrespondences);
  options.is_one_to_one = false;
  EXPECT_NE(stochasticGradientIcp(source, search, Vector6d::Ones(), options).end,
            DescentEnd::TooFewCorrespondences);
}

TEST(StochasticGradientIcp, GivesUpAfterAHundredMiniBatchesWithoutPairs)
{
  const NoisyPair pair(0.0);
  StochasticGradientIcpOptions options;
  options.batch_size = 10;
  for (const int num_empty : {99, 100}) {
    KnownPairs search(pair.target);
    search.num_empty_calls = num_empty;
    const auto result =
        stochasticGradientIcp(pair.source, search, Vector6d::Ones(), options);
    if (num_empty < 100) {
      EXPECT_NE(result.end, DescentEnd::TooFewCorrespondences);
      EXPECT_EQ(search.num_calls, 99 + result.num_iterations);
      continue;
    }
    EXPECT_EQ(result.end, DescentEnd::TooFewCorrespondences);
    EXPECT_EQ(search.num_calls, 100);
    EXPECT_EQ(result.num_iterations, 0);
    EXPECT_FALSE(result.has_converged);
    EXPECT_EQ(result.pose, Vector6d::Ones());
  }
  // The whole source again would give the same answer.
  options.batch_size = 1000;
  KnownPairs search(pair.target);
  search.num_empty_calls = 1000;
  EXPECT_EQ(stochasticGradientIcp(pair.source, search, Vector6d::Zero(), options).end,
            DescentEnd::TooFewCorrespondences);
  EXPECT_EQ(search.num_calls, 1);
}

TEST(StochasticGradientIcp, KeepsTheLastFinitePose)
{
  const NoisyPair pair(0.0);
  StochasticGradientIcpOptions options;
  options.is_one_to_one = false;
  for (const SgdOptimizer optimizer : all_optimizers)
    for (const double far : {1e308, std::numeric_limits<double>::quiet_NaN()}) {
      options.optimizer = optimizer;
      const auto result = stochasticGradientIcp(
          pair.source,
          KnownPairs(Eigen::Matrix3Xd::Constant(3, pair.source.cols(), far)),
          Vector6d::Ones(),
          options);
      EXPECT_EQ(result.end, DescentEnd::Diverged) << toString(optimizer) << far;
      EXPECT_EQ(result.pose, Vector6d::Ones());
      EXPECT_FALSE(result.has_converged);
    }
}

TEST(StochasticGradientIcp, ALongLeverArmIsTooMuchForStepOne)
{
  // 20 m from the origin the curvature of an angle is 400 m^2, a stable step below
  // 2 / 401.
  Random random(12, 0);
  const Eigen::Matrix3Xd source =
      test::randomPoints(random, 100, Eigen::Vector3d(20.0, 0.0, 0.0));
  Eigen::Matrix3Xd target, moved;
  movePoints(0.01 * Vector6d::Ones(), source, target);
  StochasticGradientIcpOptions options;
  options.optimizer = SgdOptimizer::FixedStep;
  options.batch_size = 100;
  options.translation_epsilon = 0.0;
  const auto distanceWith = [&](double step_size) {
    options.step_size = step_size;
    const auto result =
        stochasticGradientIcp(source, KnownPairs(target), Vector6d::Zero(), options);
    movePoints(result.pose, source, moved);
    return (moved - target).norm();
  };
  EXPECT_GT(distanceWith(1.0), (source - target).norm());
  EXPECT_LT(distanceWith(1.0 / 401.0), 0.1 * (source - target).norm());
}

TEST(StochasticGradientIcp, RefusesBadInput)
{
  const NoisyPair pair(0.0);
  const KnownPairs search(pair.target);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto from_nan =
      stochasticGradientIcp(pair.source, search, nan * Vector6d::Ones());
  EXPECT_EQ(from_nan.end, DescentEnd::InvalidInput);
  EXPECT_EQ(from_nan.pose, Vector6d::Zero());
  EXPECT_EQ(
      stochasticGradientIcp(pair.source.leftCols(2), search, Vector6d::Zero()).end,
      DescentEnd::InvalidInput);
  const auto complaintOf = [&](auto change) {
    StochasticGradientIcpOptions options;
    change(options);
    EXPECT_EQ(stochasticGradientIcp(pair.source, search, Vector6d::Zero(), options).end,
              DescentEnd::InvalidInput);
    const std::string complaint = options.validate();
    return complaint.substr(0, complaint.find(' '));
  };
  using Options = StochasticGradientIcpOptions;
  EXPECT_EQ(complaintOf([](Options& o) { o.step_size = 0.0; }), "step_size");
  EXPECT_EQ(complaintOf([](Options& o) { o.batch_size = 0; }), "batch_size");
  EXPECT_EQ(complaintOf([](Options& o) { o.max_iterations = 0; }), "max_iterations");
  EXPECT_EQ(complaintOf([&](Options& o) { o.translation_epsilon = nan; }),
            "translation_epsilon");
  EXPECT_EQ(complaintOf([](Options& o) { o.rotation_epsilon = -1.0; }),
            "rotation_epsilon");
  EXPECT_EQ(complaintOf([](Options& o) { o.num_still_iterations = 0; }),
            "num_still_iterations");
  EXPECT_EQ(StochasticGradientIcpOptions().validate(), "");
  EXPECT_EQ(search.num_calls, 0);
}

TEST(StochasticGradientIcp, IsAFunctionOfTheSeed)
{
  const NoisyPair pair(0.02, 200);
  const test::BruteForceSearch search(pair.target);
  StochasticGradientIcpOptions options;
  options.batch_size = 20;
  for (const SgdOptimizer optimizer : all_optimizers) {
    options.optimizer = optimizer;
    const auto run = [&](std::uint64_t seed) {
      options.seed = seed;
      return stochasticGradientIcp(pair.source, search, Vector6d::Zero(), options);
    };
    EXPECT_EQ(run(1).pose, run(1).pose);
    EXPECT_NE(run(1).pose, run(2).pose);
  }
}

TEST(StochasticGradientIcp, TellsOfEveryStepAndStopsWhenTold)
{
  const NoisyPair pair(0.0);
  const KnownPairs search(pair.target);
  std::vector<Vector6d> poses;
  const auto result = stochasticGradientIcp(
      pair.source,
      search,
      Vector6d::Zero(),
      StochasticGradientIcpOptions(),
      [&](int iteration, const Vector6d& pose) {
        poses.push_back(pose);
        EXPECT_EQ(static_cast<std::size_t>(iteration), poses.size());
        return iteration < 7;
      });
  EXPECT_EQ(result.end, DescentEnd::Cancelled);
  EXPECT_EQ(result.num_iterations, 7);
  ASSERT_EQ(poses.size(), 7u);
  EXPECT_EQ(result.pose, poses.back());
}

} // namespace
} // namespace bayesian_icp
