// SGD-ICP on a committed pair of scans: its results scatter about what all points
// together give.
#include "class/scan_pair.h"

#include <pcl/registration/stochastic_gradient_icp.h>

namespace pcl::test {
namespace {

using bayesian_icp::Vector6d;
using SgdIcp = StochasticGradientDescentIterativeClosestPoint<PointXYZ, PointXYZ>;

class SgdScans : public ::testing::Test {
protected:
  SgdScans()
  {
    // An eighth of the source, to be quick.
    bayesian_icp::Random random(1, 0);
    const auto size = static_cast<Eigen::Index>(pair_.source->size());
    for (const auto index : bayesian_icp::randomChoice(size, size / 8, random))
      some_->push_back(static_cast<index_t>(index));
  }

  /** Error of the pose from the true one, with pairs not filtered. */
  Vector6d
  error(int batch_size, std::uint64_t seed)
  {
    SgdIcp icp;
    auto options = icp.getOptions();
    options.optimizer = bayesian_icp::SgdOptimizer::Momentum;
    options.batch_size = batch_size;
    options.seed = seed;
    options.is_one_to_one = false;
    options.max_iterations = 300;
    options.translation_epsilon = 0.0; // never at rest
    icp.setOptions(options);
    icp.setIndices(some_);
    aligned(icp, pair_.source, pair_.target);
    return (bayesian_icp::poseError(icp.getResult().pose,
                                    bayesian_icp::poseOf(pair_.T_target_source),
                                    bayesian_icp::CovarianceConvention::R3xSO3));
  }

  const ScanPair pair_{"table"};
  IndicesPtr some_{new Indices};
  QuietConsole quiet_;
};

TEST_F(SgdScans, MiniBatchesComeAsNearToTheTruthAsAllPointsUpToTheirNoise)
{
  constexpr int num_runs = 10;
  const Vector6d full = error(1 << 20, 0);
  Vector6d mean = Vector6d::Zero(), squares = Vector6d::Zero();
  for (std::uint64_t seed = 1; seed <= num_runs; ++seed) {
    const Vector6d e = error(150, seed);
    mean += e / num_runs;
    squares += (e - full).cwiseAbs2() / num_runs;
  }
  for (int k = 0; k < 6; ++k) {
    // Ten runs about the truth less what all points miss it by; 4.8 is the 99.9 %
    // quantile of |t| with nine degrees of freedom.
    EXPECT_LT(std::abs(mean[k]),
              std::abs(full[k]) + 4.8 * std::sqrt(squares[k] / num_runs))
        << "coordinate " << k;
    // Not by standing still: the source started 30 mm and 0.08 rad from there.
    EXPECT_LT(std::sqrt(squares[k]), 0.02) << "coordinate " << k;
  }
}

} // namespace
} // namespace pcl::test
