// Preset `exact` on a cube started wide: 24 poses fit equally well. Whatever chains
// find has to be reported as what it is, a share of the symmetric poses.
#include <bayesian_icp/pipeline.h>
#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <set>
#include <sstream>
#include <string>

namespace bayesian_icp {

/** How GoogleTest names the test's parameter. */
static void
PrintTo(ExactSteps use, std::ostream* stream)
{
  *stream << (use == ExactSteps::Langevin ? "Langevin" : "Automatic");
}

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

/** Largest entry of a rotation's distance from the nearest of the cube's 24. */
double
distanceFromSymmetry(const Eigen::Matrix3d& rotation)
{
  const Eigen::Matrix3d rounded = rotation.array().round();
  return (rotation - rounded).cwiseAbs().maxCoeff();
}

class Cube : public ::testing::TestWithParam<ExactSteps> {};

TEST_P(Cube, StartedWideIsFoundInSymmetricPosesAndNeverCalledMixed)
{
  Random random(96, 0);
  const Eigen::Matrix3Xd source = cubeFaces(random, 600);
  const Eigen::Matrix3Xf target = cubeFaces(random, 20000).cast<float>();
  Options options;
  options.preset = Preset::Exact;
  options.exact.steps = GetParam();
  options.exact.scale.effective_points = 300.0;
  options.exact.scale.measurement_sigma = 0.003;
  options.prior.variance << 0.01, 0.01, 0.01, 1.0, 1.0, 1.0;
  options.chains.num_chains = 8;
  options.chains.num_draws = 400;
  options.exact.initial_spread = Vector6d(0.02, 0.02, 0.02, 1.0, 1.0, 1.0);
  const auto estimate =
      estimatePosterior(source, KdTree(target), Vector6d::Zero(), options);

  ASSERT_EQ(estimate.samples.rows(), 400) << estimate.summary.message;
  std::set<std::string> poses;
  for (Eigen::Index i = 0; i < estimate.samples.rows(); ++i) {
    const Eigen::Matrix3d R = rotationOf(estimate.samples.row(i).transpose());
    ASSERT_LT(distanceFromSymmetry(R), 0.1) << estimate.samples.row(i);
    std::ostringstream pose;
    pose << R.array().round().cast<int>();
    poses.insert(pose.str());
  }
  EXPECT_GE(poses.size(), 3u);
  const auto status = estimate.summary.status;
  EXPECT_TRUE(status == Status::SeveralModes || status == Status::NotMixed)
      << estimate.summary.message;
}

INSTANTIATE_TEST_SUITE_P(
    Exact, Cube, ::testing::Values(ExactSteps::Automatic, ExactSteps::Langevin));

} // namespace
} // namespace bayesian_icp
