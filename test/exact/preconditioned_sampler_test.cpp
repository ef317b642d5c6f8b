// The sampler of preset `exact` on densities whose moments are known: no point clouds.
#include "summary/estimates.h"
#include "support/test_energies.h"
#include "support/test_support.h"

#include <bayesian_icp/summary.h>

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <cmath>

namespace bayesian_icp {
namespace {

using namespace test;

/** A precision with eigenvalues from \p smallest to \p largest in random directions. */
Matrix6d
randomPrecision(double smallest, double largest)
{
  Random random(81, 0);
  const Matrix6d m = randomSquare(random);
  const Matrix6d basis =
      Eigen::SelfAdjointEigenSolver<Matrix6d>(m + m.transpose()).eigenvectors();
  Vector6d values;
  for (int k = 0; k < 6; ++k)
    values[k] = smallest * std::pow(largest / smallest, k / 5.0);
  return basis * values.asDiagonal() * basis.transpose();
}

/** Means within 4.5 Monte Carlo errors, and in units of the true distribution the draws
 * have unit covariance: a standardised second moment over n_eff draws has an error of
 * sqrt(2 / n_eff). */
void
expectMoments(const ChainSet& set, const Vector6d& mean, const Matrix6d& covariance)
{
  const Summary summary = summarize(set);
  double least_ess = 1e9;
  for (int k = 0; k < 6; ++k) {
    const auto& c = summary.coordinates[static_cast<std::size_t>(k)];
    EXPECT_NEAR(c.mean, mean[k], 4.5 * c.mcse) << k;
    least_ess = std::min(least_ess, c.bulk_ess);
  }
  EXPECT_GT(least_ess, 900.0);
  const Matrix6d white =
      Eigen::LLT<Matrix6d>(covariance).matrixL().solve(Matrix6d(Matrix6d::Identity()));
  // Of six numbers that are Gaussian, not of poses: about the means of each.
  const PoseMatrix draws = pooledDraws(set.chains);
  const Matrix6d standardised =
      white *
      covarianceAbout(coordinateMeans(draws), draws, CovarianceConvention::Parameters) *
      white.transpose();
  EXPECT_LT((standardised - Matrix6d::Identity()).cwiseAbs().maxCoeff(),
            4.5 * std::sqrt(2.0 / least_ess));
}

TEST(PreconditionedSampler, GaussiansWellAndBadlyConditioned)
{
  const Vector6d mean(0.3, -0.5, 1.0, 0.1, -0.2, 0.3);
  for (const double condition : {10.0, 1e6}) {
    const Matrix6d precision = randomPrecision(30.0, 30.0 * condition);
    const auto energy = gaussianEnergy(mean, precision);
    for (const auto steps : {ExactSteps::Langevin, ExactSteps::Metropolis}) {
      ExactOptions sampler;
      sampler.steps = steps;
      const ChainSet set = sample(energy, sampler, chainOptions(4000));
      expectMoments(set, mean, precision.inverse());
      EXPECT_EQ(set.modes.size(), 1u);
      EXPECT_EQ(summarize(set).status, Status::Ok) << summarize(set).message;
    }
  }
}

TEST(PreconditionedSampler, NoiseOfTheGradientDoesNotWidenTheDraws)
{
  // Noise that is not aligned with the density, at variances w of about 0.1 to 20.
  const Matrix6d precision = randomPrecision(100.0, 1e4);
  auto energy = gaussianEnergy(Vector6d::Zero(), precision);
  energy.num_terms = 100000;
  const Vector6d scale(1.0, 5.0, 2.0, 0.5, 3.0, 1.0);
  const Matrix6d root = Eigen::LLT<Matrix6d>(precision).matrixL();
  energy.term_noise = std::sqrt(160.0) * root * scale.asDiagonal();
  for (const Automatic<int>& batch_size : {Automatic<int>(), Automatic<int>(160)}) {
    ExactOptions sampler;
    sampler.batch_size = batch_size;
    const ChainSet set = sample(energy, sampler, chainOptions(4000));
    expectMoments(set, Vector6d::Zero(), precision.inverse());
  }
}

TEST(PreconditionedSampler, ADirectionWithoutLikelihoodKeepsItsPrior)
{
  Vector6d precision = Vector6d::Constant(1e4);
  precision[2] = precision[5] = 0.0;
  auto energy = gaussianEnergy(Vector6d::Zero(), precision.asDiagonal());
  energy.prior_precision.setConstant(4.0); // sd 0.5
  energy.start_spread = 0.5;
  const ChainSet set = sample(energy, ExactOptions(), chainOptions(4000));
  const Vector6d total = precision + energy.prior_precision;
  expectMoments(set, Vector6d::Zero(), total.cwiseInverse().asDiagonal());
}

TEST(PreconditionedSampler, ABananaIsExactWithMetropolisAndCloseWithout)
{
  const auto deviations = [](double bend) {
    Vector6d variance = Vector6d::Constant(0.09);
    variance[1] = 0.05 * 0.05 + 2.0 * bend * bend * std::pow(0.3, 4);
    return Vector6d(variance.cwiseSqrt());
  };
  const double bend = 0.6;
  ExactOptions sampler;
  sampler.steps = ExactSteps::Metropolis;
  const Summary exact = summarize(sample(banana(bend), sampler, chainOptions(8000)));
  // Langevin steps of one length do not resolve a narrow bend: a milder one.
  const double mild_bend = 0.25;
  const Summary langevin =
      summarize(sample(banana(mild_bend), ExactOptions(), chainOptions(8000)));
  EXPECT_EQ(exact.status, Status::Ok) << exact.message;
  for (std::size_t k = 0; k < 6; ++k) {
    const auto& c = exact.coordinates[k];
    const double sd = deviations(bend)[static_cast<Eigen::Index>(k)];
    EXPECT_NEAR(c.mean, 0.0, 4.5 * c.mcse) << k;
    // The fourth moment of the bent coordinate is that of a chi-squared: 4 errors.
    EXPECT_NEAR(c.standard_deviation / sd, 1.0, k == 1 ? 0.12 : 0.07) << k;
    const double mild_sd = deviations(mild_bend)[static_cast<Eigen::Index>(k)];
    EXPECT_NEAR(langevin.coordinates[k].standard_deviation / mild_sd, 1.0, 0.15) << k;
  }
}

TEST(Modes, ThatRemainAreReportedWithWeightMeanAndChains)
{
  const ChainSet set = sample(mixture(1.0), ExactOptions(), chainOptions(2000, 8));
  const Summary summary = summarize(set);
  EXPECT_EQ(summary.status, Status::SeveralModes) << summary.message;
  EXPECT_NE(summary.message.find("2 modes"), std::string::npos) << summary.message;
  ASSERT_EQ(summary.modes.size(), 2u);
  EXPECT_EQ(summary.modes[0].chains.size() + summary.modes[1].chains.size(), 8u);
  // Exact for Gaussians: weights 1 : exp(-1).
  EXPECT_NEAR(summary.modes[0].weight, 1.0 / (1.0 + std::exp(-1.0)), 0.05);
  for (int i = 0; i < 2; ++i) {
    const Mode& mode = summary.modes[static_cast<std::size_t>(i)];
    EXPECT_NEAR(mode.mean[0], i == 0 ? 1.0 : -1.0, 0.02);
    EXPECT_NEAR(
        std::sqrt(mode.covariance(CovarianceConvention::Parameters)(0, 0)), 0.05, 0.01);
  }
  EXPECT_GT(summary.coordinates[0].rhat, 1.5);
}

TEST(Modes, ThatAreClearlyWorseLoseTheirChains)
{
  const ChainSet set = sample(mixture(30.0), ExactOptions(), chainOptions(2000, 8));
  EXPECT_GT(set.num_moved_chains, 0);
  EXPECT_NEAR(set.moved_by_nats, 30.0, 2.0);
  const Summary summary = summarize(set);
  EXPECT_EQ(summary.status, Status::Ok) << summary.message;
  EXPECT_NE(summary.message.find("nats worse"), std::string::npos) << summary.message;
  EXPECT_EQ(summary.modes.size(), 1u);
  EXPECT_GT(summary.coordinates[0].quantile_2_5, 0.8);
}

TEST(PreconditionedSampler, ObeysBurnInAndThinningAndReportsThem)
{
  ExactOptions options;
  options.num_burn_in = 17;
  options.thinning = 3;
  long warm_up_calls = 0, steps = 0, total = 0;
  std::vector<Vector6d> kept;
  const ChainSet set =
      sample(gaussianEnergy(Vector6d::Zero(), 100.0 * Matrix6d::Identity()),
             options,
             chainOptions(40),
             [&](const Progress& p) {
               p.steps == 0 ? ++warm_up_calls : ++steps;
               total = p.total_steps;
               EXPECT_EQ(p.pose.allFinite(), p.steps > 0);
               const long sampled = p.chain_steps - 17;
               if (p.chain == 0 && sampled > 0 && sampled % 3 == 0)
                 kept.push_back(p.pose);
               return true;
             });
  ASSERT_EQ(kept.size(), 10U);
  for (Eigen::Index i = 0; i < 10; ++i)
    EXPECT_EQ(kept[i], set.chains[0].draws.row(i).transpose());
  EXPECT_GT(warm_up_calls, 0);
  EXPECT_EQ(steps, 4 * (17 + 3 * 10));
  EXPECT_EQ(total, steps);
}

TEST(PreconditionedSampler, CanBeCancelledInWarmUpAndInSampling)
{
  const TestEnergy target =
      gaussianEnergy(Vector6d::Zero(), 100.0 * Matrix6d::Identity());
  const ChainSet early = sample(
      target, ExactOptions(), chainOptions(400), [](const Progress&) { return false; });
  EXPECT_TRUE(early.cancelled);
  for (const auto& chain : early.chains)
    EXPECT_EQ(chain.draws.rows(), 0);
  EXPECT_EQ(summarize(early).status, Status::Cancelled);
  const ChainSet late =
      sample(target, ExactOptions(), chainOptions(400), [](const Progress& p) {
        return p.steps < 300;
      });
  EXPECT_TRUE(late.cancelled);
  EXPECT_GT(pooledDraws(late.chains).rows(), 0);
  EXPECT_LT(pooledDraws(late.chains).rows(), 400);
}

} // namespace
} // namespace bayesian_icp
