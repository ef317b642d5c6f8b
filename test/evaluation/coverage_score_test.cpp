// Scores of the coverage study: posteriors that are right by construction score as the
// closed forms say.
#include "coverage/coverage_score.h"
#include "evaluation/coverage_test_support.h"

#include <gtest/gtest.h>

#include <boost/math/distributions/fisher_f.hpp>

#include <cmath>

using namespace bayesian_icp;
using namespace bayesian_icp::evaluate;

namespace {

const double pi = std::acos(-1.0);

/** Mean distance of a standard normal vector in six dimensions from 0. */
const double mean_norm = std::sqrt(2.0) * std::tgamma(3.5) / std::tgamma(3.0);

/** Four standard errors of a mean of independent values: exceeded once in 16000. */
double
fourErrors(double variance, std::size_t size)
{
  return 4.0 * std::sqrt(variance / static_cast<double>(size));
}

std::vector<CoverageRun>
scoredRuns(std::size_t num_runs, Eigen::Index num_draws)
{
  std::vector<CoverageRun> runs;
  for (std::uint64_t seed = 1; seed <= num_runs; ++seed) {
    const RightPosterior right = rightPosterior(seed, num_draws);
    runs.push_back({{"scene", "condition", seed, "right"},
                    coverageScoreOf(right.problem, right.result)});
    EXPECT_TRUE(runs.back().score.is_valid);
  }
  return runs;
}

/** Kolmogorov's distance to the uniform distribution. */
double
distanceToUniform(std::vector<double> values)
{
  std::sort(values.begin(), values.end());
  const auto size = static_cast<double>(values.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i)
    distance = std::max({distance,
                         values[i] - static_cast<double>(i) / size,
                         static_cast<double>(i + 1) / size - values[i]});
  return distance;
}

void
expectUniformPit(const std::vector<CoverageRun>& runs)
{
  for (int k = 0; k < 6; ++k) {
    std::vector<double> pit;
    pit.reserve(runs.size());
    for (const CoverageRun& run : runs)
      pit.push_back(run.score.pit[k]);
    // Exceeded with probability 2 exp(-2 2.2^2) = 1.2e-4.
    EXPECT_LT(distanceToUniform(pit), 2.2 / std::sqrt(static_cast<double>(runs.size())))
        << k;
  }
}

/** The energy score of X with the truth from the same distribution: half the mean
 * distance of two draws, sqrt(2) mean_norm in units of their deviation. */
void
expectEnergyScoreOfRightOnes(const std::vector<CoverageRun>& runs)
{
  double sum = 0.0, square_sum = 0.0;
  for (const CoverageRun& run : runs) {
    sum += run.score.energy_score;
    square_sum += run.score.energy_score * run.score.energy_score;
  }
  const auto size = static_cast<double>(runs.size());
  const double mean = sum / size;
  EXPECT_NEAR(mean,
              relative_width * mean_norm / std::sqrt(2.0),
              fourErrors(square_sum / size - mean * mean, runs.size()));
}

} // namespace

TEST(CoverageScore, RightGaussianIsCalibrated)
{
  const auto runs = scoredRuns(1500, 0);
  // Variance of chi-square with 6 degrees of freedom: 12.
  EXPECT_NEAR(6.0 * aneesOf(runs), 6.0, fourErrors(12.0, runs.size()));
  for (const double level : {0.5, 0.68, 0.9, 0.95})
    EXPECT_NEAR(
        coverageOf(runs, level), level, fourErrors(level * (1.0 - level), runs.size()));
  // -log((2 pi)^3 width^6) - NEES / 2; the variance of the latter is 12 / 4.
  EXPECT_NEAR(meanOf(runs, &CoverageScore::log_score),
              -3.0 * std::log(2.0 * pi) - 6.0 * std::log(relative_width) - 3.0,
              fourErrors(3.0, runs.size()));
  expectUniformPit(runs);
  expectEnergyScoreOfRightOnes(runs);
}

TEST(CoverageScore, RightDrawsAreCalibrated)
{
  constexpr Eigen::Index num_draws = 400;
  const auto runs = scoredRuns(1000, num_draws);
  // Hotelling: the moments are those of 400 draws.
  const double n = num_draws;
  const double factor = (1.0 + 1.0 / n) * (n - 1.0) / (n - 8.0);
  EXPECT_NEAR(
      6.0 * aneesOf(runs), 6.0 * factor, 1.1 * factor * fourErrors(12.0, runs.size()));
  expectUniformPit(runs);
  expectEnergyScoreOfRightOnes(runs);
}

TEST(CoverageScore, DrawsScoreAsTheirGaussian)
{
  constexpr Eigen::Index num_draws = 4000;
  const RightPosterior right = rightPosterior(1, num_draws);
  MethodResult gaussian = right.result;
  gaussian.draws.resize(0, 6);
  const CoverageScore drawn = coverageScoreOf(right.problem, right.result);
  const CoverageScore exact = coverageScoreOf(right.problem, gaussian);
  for (int k = 0; k < 6; ++k) {
    const double p = exact.pit[k];
    EXPECT_NEAR(drawn.pit[k], p, fourErrors(p * (1.0 - p), num_draws)) << k;
    // Of a mean and of a standard deviation s: s / sqrt(n) and s / sqrt(2 n).
    EXPECT_NEAR(drawn.z[k],
                exact.z[k],
                fourErrors(1.0 + 0.5 * exact.z[k] * exact.z[k], num_draws));
  }
}

TEST(CoverageScore, GaussianScoresAreTheClosedForms)
{
  RightPosterior right = rightPosterior(1, 0);
  const Vector6d sd = (Vector6d() << 0.01, 0.02, 0.03, 0.04, 0.05, 0.06).finished();
  const Vector6d twist = (Vector6d() << 0.02, -0.02, 0.0, 0.04, 0.1, -0.03).finished();
  right.result.covariance = sd.cwiseAbs2().asDiagonal();
  right.problem.truth = movedBy(twist, right.result.centre, right.result.mean);
  const CoverageScore score = coverageScoreOf(right.problem, right.result);
  const Vector6d z = twist.cwiseQuotient(sd);
  double log_density = 0.0;
  for (int k = 0; k < 6; ++k) {
    EXPECT_NEAR(score.z[k], z[k], 1e-9);
    EXPECT_NEAR(score.pit[k], 0.5 * (1.0 + std::erf(z[k] / std::sqrt(2.0))), 1e-9);
    const double relative_sd = sd[k] / right.problem.prior_sd[k];
    EXPECT_NEAR(score.relative_sd[k], relative_sd, 1e-12);
    log_density += -0.5 * z[k] * z[k] - std::log(relative_sd * std::sqrt(2.0 * pi));
  }
  EXPECT_NEAR(score.nees, z.squaredNorm(), 1e-9);
  EXPECT_NEAR(score.log_score, log_density, 1e-9);
}

TEST(CoverageScore, TakesCorrelationIntoAccount)
{
  RightPosterior right = rightPosterior(1, 0);
  Matrix6d factor = 0.02 * Matrix6d::Identity();
  factor(5, 0) = 0.1;
  factor(3, 1) = -0.07;
  Vector6d z;
  z << 1.0, -2.0, 0.5, 1.5, 0.0, -1.0;
  right.result.covariance = factor * factor.transpose();
  right.problem.truth = movedBy(factor * z, right.result.centre, right.result.mean);
  const CoverageScore score = coverageScoreOf(right.problem, right.result);
  EXPECT_NEAR(score.nees, z.squaredNorm(), 1e-9);
  EXPECT_NEAR(score.log_score,
              -0.5 * z.squaredNorm() - 3.0 * std::log(2.0 * pi) - 6.0 * std::log(0.02) +
                  right.problem.prior_sd.array().log().sum(),
              1e-9);
}

TEST(CoverageScore, AddsTheTruthsOwnAccuracy)
{
  RightPosterior right = rightPosterior(1, 0);
  right.result.covariance = 9e-4 * Matrix6d::Identity();
  Vector6d twist = Vector6d::Zero();
  twist[0] = 0.1;
  twist[5] = 0.26;
  right.problem.truth = movedBy(twist, right.result.centre, right.result.mean);
  right.problem.truth_sd.translation = 0.04;
  right.problem.truth_sd.rotation = 0.12;
  const CoverageScore score = coverageScoreOf(right.problem, right.result);
  // 0.03^2 + 0.04^2 = 0.05^2.
  EXPECT_NEAR(score.z[0], 2.0, 1e-9);
  EXPECT_NEAR(score.z[5], 0.26 / std::hypot(0.03, 0.12), 1e-9);
  // A draw at the mean, eight times, is smeared alike.
  right.result.draws = poseOf(right.result.mean.matrix()).transpose().replicate(8, 1);
  const CoverageScore smeared = coverageScoreOf(right.problem, right.result);
  ASSERT_TRUE(smeared.is_valid);
  EXPECT_NEAR(smeared.z[0], 2.5, 1e-9);
  EXPECT_NEAR(smeared.pit[0], 0.5 * (1.0 + std::erf(2.5 / std::sqrt(2.0))), 1e-9);
}

TEST(CoverageScore, OfARecordingHasTheTruthsAccuracyAtTheSensor)
{
  RightPosterior right = rightPosterior(1, 0);
  right.problem.lost_displacement = 10.0;
  right.problem.truth_sd.translation = 4e-4;
  right.problem.truth_sd.rotation = 1.2e-3;
  right.result.covariance = 1e-14 * Matrix6d::Identity();
  right.problem.sensor << 3.0, -2.0, 5.0;
  // A turn about the sensor, then a shift of it: each in its own unit.
  const Eigen::Isometry3d& mean = right.result.mean;
  const Eigen::Vector3d turn(1.2e-3, 0.0, 2.4e-3);
  right.problem.truth = mean;
  right.problem.truth.linear() = expSO3(turn) * mean.linear();
  right.problem.truth.translation() +=
      (mean.linear() - right.problem.truth.linear()) * right.problem.sensor +
      Eigen::Vector3d(0.0, 4e-4, 0.0);
  EXPECT_NEAR(coverageScoreOf(right.problem, right.result).nees, 1.0 + 1.0 + 4.0, 0.2);
}

TEST(CoverageScore, MeasuresErrorsAtTheCentroidOfTheSource)
{
  RightPosterior right = rightPosterior(1, 0);
  const Eigen::Vector3d centroid = right.problem.source.rowwise().mean();
  Vector6d twist = Vector6d::Zero();
  twist.tail<3>() << 0.0, 0.3, 0.4;
  // Turned about the centroid, so that this stays; then shifted by 0.1 m.
  right.result.mean =
      Eigen::Translation3d(0.0, 0.1, 0.0) *
      movedBy(twist, right.problem.truth * centroid, right.problem.truth);
  const CoverageScore score = coverageScoreOf(right.problem, right.result);
  EXPECT_NEAR(score.translation_error, 0.1, 1e-9);
  EXPECT_NEAR(score.rotation_error, 0.5, 1e-9);
}

TEST(CoverageScore, RefusesWhatIsNoPosterior)
{
  const RightPosterior right = rightPosterior(1, 0);
  MethodResult singular = right.result, few = right.result, lost = right.result;
  singular.covariance.row(2).setZero();
  singular.covariance.col(2).setZero();
  few.draws = PoseMatrix::Random(7, 6);
  lost.mean.translation().setConstant(std::nan(""));
  for (const MethodResult& result : {singular, few, lost}) {
    const CoverageScore score = coverageScoreOf(right.problem, result);
    EXPECT_FALSE(score.is_valid);
    EXPECT_FALSE(score.notes.empty());
    EXPECT_TRUE(std::isnan(score.nees));
  }
}

TEST(CoverageScore, OfARecordingIsInMetresAndBounded)
{
  RightPosterior right = rightPosterior(1, 0);
  const double log_score = coverageScoreOf(right.problem, right.result).log_score;
  right.problem.lost_displacement = 0.1;
  EXPECT_NEAR(coverageScoreOf(right.problem, right.result).log_score,
              log_score - right.problem.prior_sd.array().log().sum(),
              1e-9);
  right.result.mean = Eigen::Translation3d(0.0, 0.0, 3.0) * right.problem.truth;
  const CoverageScore lost = coverageScoreOf(right.problem, right.result);
  EXPECT_NEAR(lost.displacement, 3.0, 1e-9);
  EXPECT_TRUE(lost.isLost());
  EXPECT_EQ(lost.log_score, min_log_score);
  right.problem.lost_displacement = 3.1;
  EXPECT_FALSE(coverageScoreOf(right.problem, right.result).isLost());
  right.result.is_valid = false;
  const CoverageScore missing = coverageScoreOf(right.problem, right.result);
  EXPECT_TRUE(missing.isLost());
  EXPECT_EQ(missing.log_score, min_log_score);
  EXPECT_EQ(missing.region, 1.0);
}

TEST(CoverageScore, OfAPoseAloneHasErrorsOnly)
{
  RightPosterior right = rightPosterior(1, 0);
  right.problem.lost_displacement = 0.1;
  right.result.is_pose_only = true;
  right.result.mean = Eigen::Translation3d(0.0, 0.0, 0.2) * right.problem.truth;
  const CoverageScore score = coverageScoreOf(right.problem, right.result);
  EXPECT_FALSE(score.is_valid);
  EXPECT_TRUE(score.isLost());
  EXPECT_NEAR(score.translation_error, 0.2, 1e-9);
  EXPECT_TRUE(std::isnan(score.nees));
  EXPECT_TRUE(std::isnan(score.log_score));
}

TEST(CoverageRegion, OfAGaussianIsChiSquares)
{
  // Tables: the 50, 95 and 99 % points with six degrees of freedom.
  EXPECT_NEAR(regionOf(5.348), 0.50, 1e-4);
  EXPECT_NEAR(regionOf(12.592), 0.95, 1e-5);
  EXPECT_NEAR(regionOf(16.812), 0.99, 1e-5);
  EXPECT_NEAR(regionOf(12.592, {20, 0}), 0.95, 1e-5); // the prior holds everything
  EXPECT_TRUE(std::isnan(regionOf(std::nan(""))));
}

TEST(CoverageRegion, OfStudentsIsFishersF)
{
  // d^2 = 6 F (nu - 2) / nu; the midpoint rule of 64 nodes is good to some 1e-4.
  for (const double distance : {1.0, 4.0, 8.0, 12.592, 20.0})
    for (const int nu : {5, 20, 60}) {
      const boost::math::fisher_f fisher(6, nu);
      EXPECT_NEAR(regionOf(distance, {nu, 6}),
                  boost::math::cdf(fisher, distance * nu / (6.0 * (nu - 2))),
                  1e-3);
    }
}

TEST(CoverageRegion, OfStudentsInFourDirectionsIsThatOfItsDraws)
{
  constexpr int num_draws = 20000, nu = 8;
  Random random(1, 0);
  const double distance = 7.0;
  int num_inside = 0;
  for (int i = 0; i < num_draws; ++i) {
    double chi_squared = 0.0;
    for (int k = 0; k < nu; ++k)
      chi_squared += std::pow(random.normal(), 2);
    const Vector6d z = random.normal6();
    num_inside +=
        z.head<4>().squaredNorm() * (nu - 2) / chi_squared + z.tail<2>().squaredNorm() <
                distance
            ? 1
            : 0;
  }
  const double share = double(num_inside) / num_draws;
  EXPECT_NEAR(regionOf(distance, {nu, 4}),
              share,
              1e-3 + fourErrors(share * (1.0 - share), num_draws));
}
