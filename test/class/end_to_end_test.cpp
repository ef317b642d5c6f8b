// The class on the committed scans, whose truth is known: forward, inverse, and from
// perturbed guesses.
#include "class/scan_pair.h"
#include "support/test_support.h"

#include <Eigen/LU>

namespace pcl::test {
namespace {

using bayesian_icp::Vector6d;
using bayesian_icp::test::chi_square_999;
using bayesian_icp::test::squaredErrorOf;

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
    aligned(icp, source, target, guess);
    ASSERT_EQ(icp.getSamples().rows(), 4000);
  }

  const ScanPair pair{GetParam()};
  const Vector6d truth = bayesian_icp::poseOf(pair.T_target_source);
  BayesianIcp icp;
  QuietConsole quiet;
};

TEST_P(EndToEnd, ThePosteriorHoldsTheTruthAndNotAPoseFarOff)
{
  sample(pair.source, pair.target);
  EXPECT_LT(squaredErrorOf(icp.getSummary(), truth), chi_square_999);
  for (int k = 0; k < 3; ++k)
    EXPECT_GT(squaredErrorOf(icp.getSummary(), truth + 0.5 * Vector6d::Unit(k)),
              chi_square_999)
        << k;
}

TEST_P(EndToEnd, TheInverseRegistrationHasTheInversePosterior)
{
  sample(pair.target, pair.source);
  const Vector6d inverse = bayesian_icp::poseOf(pair.T_target_source.inverse());
  EXPECT_LT(squaredErrorOf(icp.getSummary(), inverse), chi_square_999);
}

TEST_P(EndToEnd, PerturbedGuessesLeadToAPosteriorThatHoldsTheTruth)
{
  icp.setPrior(Vector6d::Zero(), Vector6d::Constant(0.125));
  bayesian_icp::Random random(1, 0);
  const Vector6d spread(0.02, 0.02, 0.02, 0.05, 0.05, 0.05);
  for (int i = 0; i < 2; ++i) {
    const Vector6d guess = truth + spread.cwiseProduct(random.normal6());
    sample(pair.source, pair.target, bayesian_icp::matrixOf(guess).cast<float>());
    EXPECT_LT(squaredErrorOf(icp.getSummary(), truth), chi_square_999);
  }
}

INSTANTIATE_TEST_SUITE_P(OnData, EndToEnd, ::testing::Values("mug", "table"));

} // namespace
} // namespace pcl::test
