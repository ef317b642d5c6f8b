// Preset `exact` where the posterior has several modes.
#include <bayesian_icp/pipeline.h>
#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <sstream>
#include <string>

namespace bayesian_icp {
namespace {

/** Of eight chains. */
Options
optionsWith(ExactSteps steps, int num_draws)
{
  Options options;
  options.preset = Preset::Exact;
  options.exact.scale.effective_points = 300.0;
  options.exact.scale.measurement_sigma = 0.003;
  options.exact.steps = steps;
  options.chains.num_chains = 8;
  options.chains.num_draws = num_draws;
  return options;
}

/** One period of ridges along x, repeated exactly: modes 0.1 m apart that weigh the
 * same, as nothing else holds x. */
struct Groove {
  static constexpr double period = 0.1;
  Eigen::Matrix3Xf target;
  Eigen::Matrix3Xd source;

  /** \param[in] num_shifts periods by which the source may be shifted either way and is
   * still over the target */
  explicit Groove(int num_shifts)
  : target(3, (10 + 2 * num_shifts) * 800)
  , source(3, 400)
  {
    Random random(95, 0);
    const auto pointAt = [&](double x) {
      const double phase = 2.0 * std::acos(-1.0) * x / period;
      return Eigen::Vector3d(x, random.uniform(), 0.02 * std::cos(phase));
    };
    const Eigen::Index num_periods = 10 + 2 * num_shifts;
    for (Eigen::Index i = 0; i < 800; ++i) {
      const Eigen::Vector3d point = pointAt(period * random.uniform());
      for (Eigen::Index k = 0; k < num_periods; ++k)
        target.col(num_periods * i + k) =
            (point +
             static_cast<double>(k - num_shifts) * period * Eigen::Vector3d::UnitX())
                .cast<float>();
    }
    for (Eigen::Index i = 0; i < source.cols(); ++i)
      source.col(i) = pointAt(random.uniform());
  }
};

PosteriorEstimate
estimateGroove(ExactSteps steps, int num_shifts, int num_draws)
{
  const Groove groove(num_shifts);
  Options options = optionsWith(steps, num_draws);
  options.exact.initial_spread = Vector6d(0.08, 0.01, 0.01, 0.01, 0.01, 0.01);
  return estimatePosterior(
      groove.source, KdTree(groove.target), Vector6d::Zero(), options);
}

TEST(Exact, AGrooveRepeatedAlongAnAxisGivesSeveralModesWithLangevinSteps)
{
  const auto summary = estimateGroove(ExactSteps::Langevin, 5, 400).summary;
  EXPECT_EQ(summary.status, Status::SeveralModes) << summary.message;
  ASSERT_GE(summary.modes.size(), 2u);
  EXPECT_GT(summary.coordinates[0].rhat, 1.1);
  for (const auto& mode : summary.modes)
    EXPECT_NEAR(std::remainder(mode.mean[0], Groove::period), 0.0, 0.02);
}

TEST(Exact, ChainsTravelBetweenGroovesWithMetropolisSteps)
{
  const auto estimate = estimateGroove(ExactSteps::Automatic, 1, 2000);
  EXPECT_EQ(estimate.summary.status, Status::Ok) << estimate.summary.message;
  for (const auto& chain : estimate.chains) {
    std::set<long> grooves;
    for (Eigen::Index row = 0; row < chain.draws.rows(); ++row) {
      grooves.insert(std::lround(chain.draws(row, 0) / Groove::period));
      EXPECT_NEAR(std::remainder(chain.draws(row, 0), Groove::period), 0.0, 0.03);
    }
    EXPECT_GE(grooves.size(), 2u);
  }
}

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

/** 24 poses fit equally well. Whatever chains find has to be reported as what it is, a
 * share of them. */
TEST(Exact, ACubeStartedWideIsFoundInSymmetricPosesAndNeverCalledMixed)
{
  Random random(96, 0);
  const Eigen::Matrix3Xd source = cubeFaces(random, 600);
  const Eigen::Matrix3Xf target = cubeFaces(random, 20000).cast<float>();
  for (const auto steps : {ExactSteps::Automatic, ExactSteps::Langevin}) {
    SCOPED_TRACE(toString(steps));
    Options options = optionsWith(steps, 400);
    options.prior.variance << 0.01, 0.01, 0.01, 1.0, 1.0, 1.0;
    options.exact.initial_spread = Vector6d(0.02, 0.02, 0.02, 1.0, 1.0, 1.0);
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
