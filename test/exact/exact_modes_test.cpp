// Preset `exact` where the posterior has several modes.
#include <bayesian_icp/pipeline.h>
#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace bayesian_icp {
namespace {

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
  Options options;
  options.preset = Preset::Exact;
  options.exact.scale.effective_points = 300.0;
  options.exact.scale.measurement_sigma = 0.003;
  options.exact.steps = steps;
  options.chains.num_chains = 8;
  options.chains.num_draws = num_draws;
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

} // namespace
} // namespace bayesian_icp
