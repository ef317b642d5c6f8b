// The class on the committed scans, whose truth is known: forward, inverse, and from
// perturbed guesses.
#include "class/scan_pair.h"

#include <Eigen/LU>

namespace pcl::test {
namespace {

using bayesian_icp::CovarianceConvention;
using bayesian_icp::Vector6d;

/** 99.9 % quantile of chi-squared with six degrees of freedom. */
constexpr double chi_squared_999 = 22.46;

/** Squared Mahalanobis distance of a pose from the posterior. */
double
distance(const BayesianIcp& icp, const Vector6d& pose)
{
  const auto convention = CovarianceConvention::R3xSO3;
  const Vector6d error = bayesian_icp::poseError(pose, icp.getMean(), convention);
  return (error.dot(icp.getCovariance(convention).inverse() * error));
}

class EndToEnd : public ::testing::TestWithParam<const char*> {
protected:
  /** The step size at which algorithm 1 comes near its stated posterior. */
  EndToEnd()
  {
    bayesian_icp::Options options;
    options.preset = bayesian_icp::Preset::Paper;
    options.paper.sgld.step_size = 1e-5;
    options.paper.num_burn_in = 500;
    options.chains.num_draws = 4000;
    icp.setOptions(options);
    icp.setMaximumIterations(100);
  }

  /** The posterior of the pose that maps \p source to \p target. */
  void
  sample(const Cloud::Ptr& source,
         const Cloud::Ptr& target,
         const Eigen::Matrix4f& guess = Eigen::Matrix4f::Identity())
  {
    icp.setInputSource(source);
    icp.setInputTarget(target);
    Cloud output;
    icp.align(output, guess);
    ASSERT_EQ(icp.getSamples().rows(), 4000);
  }

  const ScanPair pair{GetParam()};
  BayesianIcp icp;
  QuietConsole quiet;
};

TEST_P(EndToEnd, ThePosteriorHoldsTheTruthAndNotAPoseFarOff)
{
  sample(pair.source, pair.target);
  const Vector6d truth = bayesian_icp::poseOf(pair.T_target_source);
  EXPECT_LT(distance(icp, truth), chi_squared_999);
  for (int k = 0; k < 3; ++k)
    EXPECT_GT(distance(icp, truth + 0.5 * Vector6d::Unit(k)), chi_squared_999) << k;
}

TEST_P(EndToEnd, TheInverseRegistrationHasTheInversePosterior)
{
  sample(pair.target, pair.source);
  EXPECT_LT(distance(icp, bayesian_icp::poseOf(pair.T_target_source.inverse())),
            chi_squared_999);
}

TEST_P(EndToEnd, PerturbedGuessesLeadToAPosteriorThatHoldsTheTruth)
{
  icp.setPrior(Vector6d::Zero(), Vector6d::Constant(0.125));
  bayesian_icp::Random random(1, 0);
  Vector6d spread;
  spread << 0.02, 0.02, 0.02, 0.05, 0.05, 0.05;
  for (int i = 0; i < 2; ++i) {
    const Vector6d guess = bayesian_icp::poseOf(pair.T_target_source) +
                           spread.cwiseProduct(random.normal6());
    sample(pair.source, pair.target, bayesian_icp::matrixOf(guess).cast<float>());
    EXPECT_LT(distance(icp, bayesian_icp::poseOf(pair.T_target_source)),
              chi_squared_999);
  }
}

INSTANTIATE_TEST_SUITE_P(OnData, EndToEnd, ::testing::Values("mug", "table"));

} // namespace
} // namespace pcl::test
