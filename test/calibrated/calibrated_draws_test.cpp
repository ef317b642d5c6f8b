// Draws of preset `calibrated` from estimates whose posterior is known: no clouds.
#include "calibrated/calibrated_stand_in.h"
#include "calibrated/draws/draw_plan.h"
#include "calibrated/draws/product_coordinates.h"
#include "summary/estimates.h"
#include "support/test_support.h"

#include <bayesian_icp/diagnostics.h>
#include <bayesian_icp/summary.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace bayesian_icp {
namespace {

using namespace test;
using Eigen::MatrixXd;

/** Values of all draws, sorted. */
std::vector<double>
sorted(const MatrixXd& values)
{
  std::vector<double> result(values.data(), values.data() + values.size());
  std::sort(result.begin(), result.end());
  return result;
}

/** Largest difference of the two distribution functions (Kolmogorov and Smirnov). */
double
largestDifference(const MatrixXd& first, const MatrixXd& second)
{
  const std::vector<double> a = sorted(first), b = sorted(second);
  double largest = 0.0;
  std::size_t j = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    while (j < b.size() && b[j] <= a[i])
      ++j;
    const double in_b = static_cast<double>(j) / static_cast<double>(b.size());
    const double n = static_cast<double>(a.size());
    largest = std::max({largest,
                        std::abs(static_cast<double>(i) / n - in_b),
                        std::abs(static_cast<double>(i + 1) / n - in_b)});
  }
  return largest;
}

/** What at least one of several comparisons exceeds with a probability of 1 % or less
 * (Bonferroni), of as many independent draws as these are worth. */
double
criticalDifference(const MatrixXd& first,
                   const MatrixXd& second,
                   int num_comparisons = 1)
{
  const auto worth = [](const MatrixXd& draws) {
    return std::min(bulkEss(draws), static_cast<double>(draws.size()));
  };
  return std::sqrt(-0.5 * std::log(0.005 / num_comparisons) *
                   (1.0 / worth(first) + 1.0 / worth(second)));
}

/** f of each draw, one chain a column. */
template <typename Function>
MatrixXd
ofDraws(const ChainSet& set, const Function& f)
{
  MatrixXd values(set.chains.front().draws.rows(), set.chains.size());
  for (Eigen::Index c = 0; c < values.cols(); ++c)
    for (Eigen::Index i = 0; i < values.rows(); ++i)
      values(i, c) =
          f(Vector6d(set.chains[static_cast<std::size_t>(c)].draws.row(i).transpose()));
  return values;
}

/** The twist of a pose from the expected mean, in standard deviations. */
Vector6d
whitened(const CalibratedEstimate& e, const Eigen::Isometry3d& pose)
{
  const Vector6d error = twistBetween(e.mode, pose, e.centre) - e.mean;
  return e.covariance.llt().matrixL().solve(error);
}

ChainSet
sample(const StandIn& problem, const BatchScore& score)
{
  return sampleCalibrated(
      score, problem.prior, {{problem.estimate}}, CalibratedOptions(), ChainOptions());
}

ChainSet
sample(const StandIn& problem)
{
  return sample(problem, problem.score());
}

/** Draws as if the likelihood were Gaussian about the mode, in ProductCoordinates, with
 * the exact prior: by steps that look at no points. */
ChainSet
sampleProductForm(const StandIn& problem)
{
  constexpr int num_chains = 4, num_draws = 2000, thinning = 30;
  const ProductCoordinates coordinates(problem.estimate);
  const auto poseAt = [&](const Vector6d& z) {
    return poseOf(coordinates.pose(z).matrix());
  };
  const auto energy = [&](const Vector6d& z) {
    return coordinates.linearEnergy(z) + problem.prior.energy(poseAt(z));
  };
  const Gaussian& gaussian = coordinates.gaussian();
  ChainSet set;
  for (std::uint64_t i = 0; i < num_chains; ++i) {
    Random random(1, i);
    PoseMatrix draws = randomWalk(
        energy, gaussian.mean(), gaussian.factor(), num_draws, thinning, random);
    for (auto draw : draws.rowwise())
      draw = poseAt(draw.transpose()).transpose();
    set.chains.push_back({draws});
  }
  return set;
}

/** Standard normal components: mean and second moments within 4.5 Monte Carlo errors,
 * and what is no Gaussian would show in the distribution function. */
void
expectTheCalibratedGaussian(const ChainSet& set, const CalibratedEstimate& estimate)
{
  MatrixXd all(set.chains.front().draws.size() / 6 * set.chains.size(), 6);
  double least_ess = 1e9;
  Random random(5, 0);
  for (int k = 0; k < 6; ++k) {
    const MatrixXd values = ofDraws(set, [&](const Vector6d& pose) {
      return whitened(estimate, isometryOf(pose))[k];
    });
    EXPECT_LT(rhat(values), max_rhat) << k;
    EXPECT_NEAR(values.mean(), 0.0, 4.5 * mcseMean(values)) << k;
    least_ess = std::min(least_ess, bulkEss(values));
    all.col(k) = values.reshaped();
    const MatrixXd normal = MatrixXd::NullaryExpr(
        values.rows(), values.cols(), [&] { return random.normal(); });
    EXPECT_LT(largestDifference(values, normal), criticalDifference(values, normal, 6))
        << k;
  }
  EXPECT_GT(least_ess, 900.0);
  const Matrix6d moments = all.transpose() * all / static_cast<double>(all.rows());
  EXPECT_LT((moments - Matrix6d::Identity()).cwiseAbs().maxCoeff(),
            4.5 * std::sqrt(2.0 / least_ess));
}

TEST(CalibratedDraws, OfLinearScoresAreTheCalibratedGaussian)
{
  // With the noise of 3, the shape is followed in part only.
  for (const double noise : {0.0, 0.5, 3.0}) {
    StandIn::Options options;
    options.noise = noise;
    const StandIn problem(options);
    SCOPED_TRACE(noise);
    expectTheCalibratedGaussian(sample(problem), problem.estimate);
  }
}

/** Squared Mahalanobis distance from the calibrated mean. */
MatrixXd
squaredDistances(const ChainSet& set, const CalibratedEstimate& e)
{
  return ofDraws(set, [&](const Vector6d& pose) {
    return whitened(e, isometryOf(pose)).squaredNorm();
  });
}

TEST(CalibratedDraws, AreStudentsWithTheDegreesOfFreedomOfTheEstimate)
{
  constexpr int nu = 5;
  StandIn problem(StandIn::Options{});
  problem.estimate.degrees_of_freedom = nu;
  const ChainSet set = sample(problem);
  const MatrixXd distances = squaredDistances(set, problem.estimate);
  // Vector of six normal numbers over the root of an independent chi-square, of unit
  // covariance.
  Random random(6, 0);
  const auto studentDistance = [&] {
    double scale = 0.0;
    for (int i = 0; i < nu; ++i)
      scale += std::pow(random.normal(), 2);
    return random.normal6().squaredNorm() * (nu - 2) / scale;
  };
  const MatrixXd expected =
      MatrixXd::NullaryExpr(distances.rows(), distances.cols(), studentDistance);
  EXPECT_LT(largestDifference(distances, expected),
            criticalDifference(distances, expected));
  // The test sees the difference from a Gaussian.
  problem.estimate.degrees_of_freedom = 0;
  const MatrixXd gaussian = squaredDistances(sample(problem), problem.estimate);
  EXPECT_GT(largestDifference(gaussian, expected),
            criticalDifference(gaussian, expected));
}

TEST(CalibratedDraws, AreStudentsOnlyWhereTheDataHoldThePose)
{
  StandIn::Options options;
  options.is_yaw_free = true;
  StandIn problem(options);
  const ProductCoordinates coordinates(problem.estimate);
  ASSERT_EQ(coordinates.numPriorOnly(), 1);
  Random random(7, 0);
  std::vector<Path> chains(2);
  for (Path& chain : chains)
    chain.positions = Matrix6Xd::NullaryExpr(6, 3, [&] { return random.normal(); });
  const std::vector<Matrix6Xd> before = {chains[0].positions, chains[1].positions};
  scaleAtRandom(coordinates, 4, random, chains);
  const Vector6d mean = 0.5 * (before[0].rowwise().mean() + before[1].rowwise().mean());
  for (std::size_t c = 0; c < 2; ++c)
    for (Eigen::Index i = 0; i < 3; ++i) {
      EXPECT_EQ(chains[c].positions(0, i), before[c](0, i));
      // One factor for all of b.
      const Vector6d old = before[c].col(i) - mean;
      const Vector6d scaled = chains[c].positions.col(i) - mean;
      const double factor = scaled[1] / old[1];
      EXPECT_GT(std::abs(factor - 1.0), 1e-6);
      EXPECT_LT((scaled - factor * old).tail<5>().norm(), 1e-12 * old.norm());
    }
}

TEST(CalibratedDraws, OfTheProductFormAreTheCalibratedGaussian)
{
  const StandIn problem(StandIn::Options{});
  expectTheCalibratedGaussian(sampleProductForm(problem), problem.estimate);
}

/** The last step of sampleCalibrated() sets the covariance right; here it is looked at
 * before. */
TEST(CalibratedDraws, HaveTheRightSpreadBeforeItIsAdjusted)
{
  StandIn::Options options;
  options.noise = 0.5; // a batch's noise is 0.6 of the posterior's variance
  const StandIn problem(options);
  WeightedScore score(problem.estimate, problem.prior, problem.score());
  Random random(3, 0);
  const StepPlan plan = planDraws(score, random);
  EXPECT_EQ(plan.batch_size, 32u);
  const Gaussian& gaussian = score.coordinates().gaussian();
  LangevinChain chain(plan, gaussian.draw(random), score, random);
  constexpr int num_steps = 20000;
  Matrix6d moments = Matrix6d::Zero();
  for (int i = 0; i < num_steps; ++i) {
    chain.step();
    const Vector6d white =
        gaussian.inverseFactor() * (chain.position() - gaussian.mean());
    moments += white * white.transpose() / num_steps;
  }
  // A step is worth b/2 draws for the mean and more for the variance.
  const double ess = 0.5 * plan.step_sizes.minCoeff() * num_steps;
  EXPECT_LT((moments - Matrix6d::Identity()).cwiseAbs().maxCoeff(),
            4.5 * std::sqrt(2.0 / ess));
}

TEST(CalibratedDraws, AgreeWithTheProductFormHoweverWideThePriorOfAFreeYawIs)
{
  for (const double yaw_sd : {0.5, 1.0, 1.5}) {
    SCOPED_TRACE(yaw_sd);
    StandIn::Options options;
    options.is_yaw_free = true;
    options.prior_yaw = yaw_sd;
    options.prior_tilt = 0.1;
    const StandIn problem(options);
    EXPECT_EQ(ProductCoordinates(problem.estimate).numPriorOnly(), 1);
    const ChainSet draws = sample(problem);
    const ChainSet oracle = sampleProductForm(problem);
    EXPECT_EQ(summarize(draws).status, Status::Ok) << summarize(draws).message;
    for (int k = 0; k < 6; ++k) {
      const auto deviation = [&](const Vector6d& pose) {
        const double difference = pose[k] - problem.prior.mean()[k];
        return k < 3 ? difference : wrapAngle(difference);
      };
      const MatrixXd a = ofDraws(draws, deviation), b = ofDraws(oracle, deviation);
      EXPECT_LT(largestDifference(a, b), criticalDifference(a, b, 6)) << k;
    }
  }
}

TEST(ProductCoordinates, GradientOfThePriorIsThatOfItsEnergy)
{
  StandIn::Options options;
  options.prior_translation = 0.5;
  options.prior_tilt = options.prior_yaw = 1.0;
  StandIn problem(options);
  Random random(8, 0);
  for (int num_free = 0; num_free <= 6; ++num_free) {
    problem.estimate.keep = Vector6d::Ones();
    problem.estimate.keep.tail(num_free).setZero();
    const ProductCoordinates coordinates(problem.estimate);
    ASSERT_EQ(coordinates.numPriorOnly(), num_free);
    const auto energy = [&](const Vector6d& z) {
      return twistPriorEnergy(problem.prior, coordinates.pose(z));
    };
    for (int i = 0; i < 5; ++i) {
      const Vector6d z = 0.05 * random.normal6();
      const Vector6d expected = centralDifferences(energy, z);
      EXPECT_LT((coordinates.priorGradient(z, problem.prior) - expected).norm(),
                1e-6 * (1.0 + expected.norm()))
          << num_free;
    }
  }
}

TEST(ProductCoordinates, VolumeIsThatOfTheMotions)
{
  StandIn problem(StandIn::Options{});
  Random random(9, 0);
  for (int num_free = 1; num_free <= 6; ++num_free) {
    problem.estimate.keep = Vector6d::Ones();
    problem.estimate.keep.tail(num_free).setZero();
    const ProductCoordinates coordinates(problem.estimate);
    const auto log_volume = [&](const Vector6d& z) {
      const Eigen::Isometry3d at = coordinates.pose(z);
      Matrix6d rates;
      for (int k = 0; k < 6; ++k) {
        const Vector6d step = 1e-4 * Vector6d::Unit(k);
        rates.col(k) =
            twistBetween(at, coordinates.pose(z + step), Eigen::Vector3d::Zero()) -
            twistBetween(at, coordinates.pose(z - step), Eigen::Vector3d::Zero());
      }
      return std::log(std::abs(rates.determinant()));
    };
    for (int i = 0; i < 5; ++i) {
      Vector6d z = random.normal6();
      z.tail(6 - num_free).setZero();
      // The next term of the series is of third order.
      const double angle =
          (problem.estimate.directions.rightCols(num_free) * z.head(num_free))
              .tail<3>()
              .norm();
      z *= 0.05 / std::max(angle, 0.05);
      Vector6d expected = centralDifferences(log_volume, z);
      expected.tail(6 - num_free).setZero();
      EXPECT_LT((coordinates.volumeGradient(z) - expected).norm(),
                1e-3 * (0.01 + expected.norm()))
          << num_free;
    }
  }
}

TEST(ProductCoordinates, DropWholeTurns)
{
  StandIn::Options options;
  options.is_yaw_free = true;
  StandIn problem(options);
  problem.estimate.directions(2, 5) = 0.01; // a screw
  const ProductCoordinates coordinates(problem.estimate);
  const Vector6d z(0.02, 0.001, -0.002, 0.001, 0.003, -0.001);
  const Vector6d turn = 2.0 * std::acos(-1.0) / 10.0 * Vector6d::Unit(0);
  for (const double num_turns : {-2.0, 1.0})
    EXPECT_LT(
        (coordinates.pose(z + num_turns * turn).matrix() - coordinates.pose(z).matrix())
            .norm(),
        1e-12);
}

TEST(CalibratedDraws, FollowTheShapeOfTheScores)
{
  StandIn::Options options;
  options.noise = 0.1;
  const StandIn problem(options);
  const CalibratedEstimate& e = problem.estimate;
  // Steeper to one side of direction 0 than to the other, by up to a standard
  // deviation's worth of the likelihood.
  const Vector6d best = -e.curvature.ldlt().solve(e.scores.total);
  const double sd = 1.0 / std::sqrt(e.information(0, 0));
  const BatchScore linear = problem.score();
  const auto skewed = [&](const CalibratedEstimate& estimate,
                          const Eigen::Isometry3d& pose,
                          const std::vector<std::size_t>& indices,
                          PatchHints& hints,
                          Vector6d& total) {
    const int num = linear(estimate, pose, indices, hints, total);
    const Vector6d xi = twistBetween(e.mode, pose, e.centre);
    const double u = std::clamp((xi - best)[0] / sd, -2.0, 2.0);
    const double share = static_cast<double>(indices.size()) / StandIn::num_points;
    total += share * e.curvature.col(0) * sd * 0.25 * (u * u - 1.0);
    return num;
  };
  const MatrixXd x = ofDraws(sample(problem, skewed), [&](const Vector6d& pose) {
    return twistBetween(e.mode, isometryOf(pose), e.centre)[0];
  });
  const Eigen::ArrayXXd centred = x.array() - x.mean();
  const double skewness =
      centred.cube().mean() / std::pow(centred.square().mean(), 1.5);
  EXPECT_LT(skewness, -4.5 * std::sqrt(6.0 / bulkEss(x)));
}

TEST(CalibratedDraws, AreGuardedAgainstScoresThatRunAway)
{
  const StandIn problem(StandIn::Options{});
  const CalibratedEstimate& e = problem.estimate;
  const auto radius = [&](const Eigen::Isometry3d& pose) {
    return whitened(e, pose).norm();
  };
  enum Fault { Outward, NotANumber, NoPatch };
  const BatchScore linear = problem.score();
  for (const Fault fault : {Outward, NotANumber, NoPatch}) {
    const auto faulty = [&](const CalibratedEstimate& estimate,
                            const Eigen::Isometry3d& pose,
                            const std::vector<std::size_t>& indices,
                            PatchHints& hints,
                            Vector6d& total) {
      const int num = linear(estimate, pose, indices, hints, total);
      if (radius(pose) < 2.5)
        return num;
      total *= fault == Outward ? -1000.0 : 1.0;
      if (fault == NotANumber)
        total.setConstant(std::nan(""));
      return fault == NoPatch ? num / 3 : num;
    };
    const ChainSet set = sample(problem, faulty);
    const MatrixXd radii =
        ofDraws(set, [&](const Vector6d& pose) { return radius(isometryOf(pose)); });
    // The likelihood's drift points back from 6 standard deviations on; 6 more for the
    // diffusion beyond, and the adjustment of the spread by 1.4.
    EXPECT_LT(radii.maxCoeff(), 1.4 * 12.0) << fault;
    for (const Chain& chain : set.chains)
      EXPECT_FALSE(chain.diverged);
  }
}

TEST(CalibratedDraws, AreOfEveryModeHoweverManyTheChains)
{
  const StandIn problem(StandIn::Options{});
  CalibratedMode heavy{problem.estimate}, light{problem.estimate};
  light.log_weight = heavy.log_weight + std::log(0.03);
  ChainOptions chains;
  chains.num_draws = 1000;
  chains.num_chains = 50; // 29 draws of the light mode
  const ChainSet set = sampleCalibrated(
      problem.score(), problem.prior, {heavy, light}, CalibratedOptions(), chains);
  ASSERT_EQ(set.modes.size(), 2u);
  ASSERT_EQ(set.chains.size(), 100u);
  for (const Chain& chain : set.chains)
    EXPECT_GE(chain.draws.rows(), 1);
}

TEST(CalibratedDraws, ReportProgressAndCanBeCancelled)
{
  const StandIn problem(StandIn::Options{});
  CalibratedOptions options;
  options.num_burn_in = 17;
  options.thinning = 3;
  ChainOptions chains;
  chains.num_draws = 40;
  const auto run = [&](const ProgressCallback& progress) {
    return sampleCalibrated(problem.score(),
                            problem.prior,
                            {{problem.estimate}},
                            options,
                            chains,
                            progress);
  };
  long num_calls = 0;
  std::vector<Vector6d> last_poses(4);
  const ChainSet complete = run([&](const Progress& progress) {
    EXPECT_EQ(progress.steps, ++num_calls);
    EXPECT_EQ(progress.total_steps, 4 * (17 + 3 * 10));
    EXPECT_TRUE(progress.pose.allFinite());
    last_poses[progress.chain] = progress.pose;
    return true;
  });
  // Told before the spread about the mean is adjusted by a factor of at most 1.4; no
  // draw is further from the mean than the root of the sum of all squares.
  const Vector6d mean = meanPose(pooledDraws(complete.chains));
  const Vector6d spread =
      (pooledDraws(complete.chains).rowwise() - mean.transpose()).colwise().norm();
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector6d kept = complete.chains[i].draws.row(9).transpose();
    EXPECT_TRUE(((last_poses[i] - kept).array().abs() < 0.5 * spread.array()).all());
    EXPECT_FALSE(last_poses[i].isZero(0.0));
  }
  EXPECT_EQ(num_calls, 4 * (17 + 3 * 10));
  EXPECT_FALSE(complete.cancelled);
  chains.num_threads = 1;
  const ChainSet stopped =
      run([](const Progress& progress) { return progress.steps < 17 + 6; });
  EXPECT_TRUE(stopped.cancelled);
  EXPECT_EQ(stopped.chains[0].draws.rows(), 2);
  EXPECT_EQ(stopped.chains[1].draws.rows(), 0);
  EXPECT_TRUE(stopped.chains[0].draws.allFinite());
  EXPECT_THROW(run([](const Progress&) -> bool { throw std::runtime_error("stop"); }),
               std::runtime_error);
}

TEST(CalibratedDraws, WithoutPriorOrDataAlongAMotionDiverge)
{
  StandIn::Options options;
  options.is_yaw_free = true;
  options.prior_yaw = std::numeric_limits<double>::infinity();
  StandIn problem(options);
  problem.estimate.keep[5] = 0.0;
  for (const Chain& chain : sample(problem).chains) {
    EXPECT_TRUE(chain.diverged);
    EXPECT_EQ(chain.draws.rows(), 0);
  }
}

} // namespace
} // namespace bayesian_icp
