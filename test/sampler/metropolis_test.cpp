// Proposals and steps of the Metropolis chains, on densities whose moments are known.
#include "sampler/metropolis.h"
#include "summary/estimates.h"
#include "support/test_energies.h"

#include <bayesian_icp/diagnostics.h>
#include <bayesian_icp/summary.h>

#include <gtest/gtest.h>

#include <Eigen/LU>

namespace bayesian_icp {
namespace {

using namespace test;

const double pi = std::acos(-1.0);

/** Correlated, of standard deviations 0.5 to 3. */
Matrix6d
exampleCovariance()
{
  const Vector6d deviations(0.5, 1.0, 2.0, 3.0, 0.7, 1.5);
  Matrix6d correlation = Matrix6d::Identity();
  correlation(0, 1) = correlation(1, 0) = 0.8;
  correlation(2, 5) = correlation(5, 2) = -0.6;
  return deviations.asDiagonal() * correlation * deviations.asDiagonal();
}

PoseMatrix
exampleDraws(int number)
{
  const Matrix6d factor = exampleCovariance().llt().matrixL();
  Random random(11, 0);
  PoseMatrix draws(number, 6);
  for (auto draw : draws.rowwise())
    draw = (factor * random.normal6()).transpose();
  return draws;
}

TEST(TMixture, OneComponentIsTheMultivariateT)
{
  TMixture mixture;
  const Vector6d mean = Vector6d::LinSpaced(-1.0, 1.0);
  const Matrix6d covariance = exampleCovariance();
  mixture.add(mean, covariance, 1.0);
  Random random(12, 0);
  for (const double distance : {0.0, 1.0, 5.0}) {
    const Vector6d d = distance * random.normal6();
    const double log_density = std::lgamma(7.0) - std::lgamma(4.0) -
                               3.0 * std::log(8.0 * pi) -
                               0.5 * std::log(covariance.determinant()) -
                               7.0 * std::log1p(d.dot(covariance.inverse() * d) / 8.0);
    EXPECT_NEAR(mixture.logDensity(mean + d), log_density, 1e-9);
  }
}

TEST(TMixture, AFittedOneIntegratesToOneAndDrawsFollowIt)
{
  // The mean of f/g over draws from g is the integral of f, for every g.
  Random random(3, 0);
  PoseMatrix draws = exampleDraws(4000);
  draws.topRows(1000).col(3).array() += 12.0;
  TMixture fitted(draws, 4, random);
  fitted.add(Vector6d::Constant(3.0), exampleCovariance(), 0.1);
  TMixture wide;
  wide.add(Vector6d::Zero(), 2.0 * exampleCovariance(), 1.0);
  wide.add(12.0 * Vector6d::Unit(3), 2.0 * exampleCovariance(), 0.3);
  wide.add(Vector6d::Constant(3.0), 2.0 * exampleCovariance(), 0.2);
  Eigen::MatrixXd wide_over_fitted(20000, 1), fitted_over_wide(20000, 1);
  const auto ratio = [](const TMixture& f, const TMixture& g, const Vector6d& x) {
    return std::exp(f.logDensity(x) - g.logDensity(x));
  };
  for (Eigen::Index i = 0; i < fitted_over_wide.rows(); ++i) {
    fitted_over_wide(i, 0) = ratio(fitted, wide, wide.draw(random));
    const Vector6d x = fitted.draw(random);
    // Its own tails are too thin to integrate the wide one: a bounded part will do.
    wide_over_fitted(i, 0) = std::min(1.0, ratio(wide, fitted, x));
  }
  EXPECT_LT(mcseMean(fitted_over_wide), 0.03);
  EXPECT_NEAR(fitted_over_wide.mean(), 1.0, 4.5 * mcseMean(fitted_over_wide));
  // The integral of min(f, g) from both sides.
  Eigen::MatrixXd other_side(20000, 1);
  for (Eigen::Index i = 0; i < other_side.rows(); ++i)
    other_side(i, 0) = std::min(1.0, ratio(fitted, wide, wide.draw(random)));
  EXPECT_NEAR(wide_over_fitted.mean(),
              other_side.mean(),
              4.5 * std::hypot(mcseMean(wide_over_fitted), mcseMean(other_side)));
}

TEST(TMixture, ComponentsFindTheClusters)
{
  // Far apart: within the clusters the covariance is the example's.
  PoseMatrix draws = exampleDraws(6000);
  draws.topRows(2000).col(1).array() += 60.0;
  Random random(4, 0);
  const TMixture mixture(draws, 8, random);
  const Matrix6d within = mixture.covarianceWithin();
  EXPECT_GT(within(1, 1), 0.3);
  EXPECT_LT(within(1, 1), 1.1);
  Eigen::MatrixXd is_first(10000, 1);
  for (Eigen::Index i = 0; i < is_first.rows(); ++i)
    is_first(i, 0) = mixture.draw(random)[1] > 30.0 ? 1.0 : 0.0;
  EXPECT_NEAR(is_first.mean(), 1.0 / 3.0, 0.025);
}

TEST(Metropolis, ABadProposalSlowsTheChainAndBiasesNothing)
{
  // Weights 1 : exp(-1); the proposal has them the wrong way round, off the modes.
  auto energy = mixture(1.0);
  auto proposal = std::make_shared<MetropolisProposal>();
  const Matrix6d covariance = 0.01 * Matrix6d::Identity();
  const Vector6d shift = Vector6d::Constant(0.02);
  proposal->jumps.add(Vector6d::Unit(0) + shift, covariance, 1.0);
  proposal->jumps.add(-Vector6d::Unit(0) + shift, covariance, 0.8);
  proposal->walk_factor = 0.05 * Matrix6d::Identity();
  Random random(13, 0);
  MetropolisChain chain(Vector6d::Unit(0), energy, random);
  chain.setProposal(proposal);
  Eigen::MatrixXd is_first(20000, 1), squares(20000, 1);
  for (Eigen::Index i = 0; i < is_first.rows(); ++i) {
    for (int step = 0; step < 6; ++step)
      chain.step();
    is_first(i, 0) = chain.position()[0] > 0.0 ? 1.0 : 0.0;
    squares(i, 0) = chain.position()[2] * chain.position()[2];
  }
  EXPECT_LT(mcseMean(is_first), 0.02);
  EXPECT_NEAR(is_first.mean(), 1.0 / (1.0 + std::exp(-1.0)), 4.5 * mcseMean(is_first));
  EXPECT_LT(mcseMean(squares), 0.05 * 0.0025);
  EXPECT_NEAR(squares.mean(), 0.0025, 4.5 * mcseMean(squares));
  EXPECT_GT(chain.jumpAcceptance(), 0.01);
  EXPECT_LT(chain.jumpAcceptance(), 0.5);
}

TEST(Metropolis, ModesThatChainsTravelBetweenAreOnePosterior)
{
  ExactOptions sampler;
  sampler.steps = ExactSteps::Metropolis;
  const ChainSet set = sample(mixture(2.0), sampler, chainOptions(4000, 8));
  const Summary summary = summarize(set);
  EXPECT_EQ(summary.status, Status::Ok) << summary.message;
  EXPECT_EQ(set.modes.size(), 1u);
  EXPECT_EQ(set.num_moved_chains, 0);
  Eigen::MatrixXd is_first(500, 8);
  for (Eigen::Index i = 0; i < 8; ++i)
    is_first.col(i) =
        (set.chains[static_cast<std::size_t>(i)].draws.col(0).array() > 0.0)
            .cast<double>();
  EXPECT_LT(mcseMean(is_first), 0.02);
  EXPECT_NEAR(is_first.mean(), 1.0 / (1.0 + std::exp(-2.0)), 4.5 * mcseMean(is_first));
}

TEST(Metropolis, IsChosenWhereBatchesAreTooNoisy)
{
  auto energy = gaussianEnergy(Vector6d::Zero(), 100.0 * Matrix6d::Identity());
  energy.num_terms = 500;
  const auto drawsWith = [&](ExactSteps use, double noise) {
    energy.term_noise = std::sqrt(100.0 * noise) * Matrix6d::Identity();
    ExactOptions sampler;
    sampler.steps = use;
    return pooledDraws(sample(energy, sampler, chainOptions(40)).chains);
  };
  // Variance of a term's gradient, posterior sd = 1, against 500 terms.
  EXPECT_EQ(drawsWith(ExactSteps::Automatic, 1000.0),
            drawsWith(ExactSteps::Metropolis, 1000.0));
  EXPECT_EQ(drawsWith(ExactSteps::Automatic, 100.0),
            drawsWith(ExactSteps::Langevin, 100.0));
}

} // namespace
} // namespace bayesian_icp
