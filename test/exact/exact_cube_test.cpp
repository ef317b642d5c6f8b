// Preset `exact` on a cube started wide: 24 poses fit equally well. Whatever chains
// find has to be reported as what it is, a share of the symmetric poses.
#include <bayesian_icp/pipeline.h>
#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <set>
#include <sstream>
#include <string>

namespace bayesian_icp {
namespace {

/** Points on the faces of a cube of 0.2 m about the origin. */
Eigen::Matrix3Xd
cubeFaces(Random& random, Eigen::Index num_points)
{
  Eigen::Matrix3Xd points(3, num_points);
  for (Eigen::Index i = 0; i < num_points; ++i) {
    const auto face = random.index(6);
    for (int k = 0; k < 3; ++k)
      points(k, i) = 0.2 * (random.uniform() - 0.5);
    points(static_cast<Eigen::Index>(face / 2), i) = face % 2 == 0 ? -0.1 : 0.1;
  }
  return points;
}

TEST(Exact, ACubeStartedWideIsFoundInSymmetricPosesAndNeverCalledMixed)
{
  Random random(96, 0);
  const Eigen::Matrix3Xd source = cubeFaces(random, 600);
  const Eigen::Matrix3Xf target = cubeFaces(random, 20000).cast<float>();
  Options options;
  options.preset = Preset::Exact;
  options.exact.scale.effective_points = 300.0;
  options.exact.scale.measurement_sigma = 0.003;
  options.prior.variance << 0.01, 0.01, 0.01, 1.0, 1.0, 1.0;
  options.chains.num_chains = 8;
  options.chains.num_draws = 400;
  options.exact.initial_spread = Vector6d(0.02, 0.02, 0.02, 1.0, 1.0, 1.0);
  for (const auto steps : {ExactSteps::Automatic, ExactSteps::Langevin}) {
    SCOPED_TRACE(toString(steps));
    options.exact.steps = steps;
    const auto estimate =
        estimatePosterior(source, KdTree(target), Vector6d::Zero(), options);
    ASSERT_EQ(estimate.samples.rows(), 400) << estimate.summary.message;
    std::set<std::string> poses;
    for (const auto& draw : estimate.samples.rowwise()) {
      const Eigen::Matrix3d R = rotationOf(draw.transpose());
      // Entries of the cube's 24 rotations are whole numbers.
      const Eigen::Matrix3d rounded = R.array().round();
      ASSERT_LT((R - rounded).cwiseAbs().maxCoeff(), 0.1) << draw;
      std::ostringstream pose;
      pose << rounded.cast<int>();
      poses.insert(pose.str());
    }
    EXPECT_GE(poses.size(), 3u);
    const auto status = estimate.summary.status;
    EXPECT_TRUE(status == Status::SeveralModes || status == Status::NotMixed)
        << estimate.summary.message;
  }
}

} // namespace
} // namespace bayesian_icp
