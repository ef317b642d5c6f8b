// What a run tells its callbacks, and of its time. A power of two loses no digits, so a
// normalised run of clouds four times as large takes exactly the steps of the plain
// run, four times as far apart.
#include "register/run.h"

#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <vector>

using namespace bayesian_icp;
using namespace bayesian_icp::app;

namespace {

constexpr float factor = 4.0F;

/** Points within the unit cube, one of them at (1, 0, 0) [m]. */
Eigen::Matrix3Xf
cloudOfUnitSize()
{
  Random random(1, 0);
  Eigen::Matrix3Xf points(3, 60);
  for (Eigen::Index i = 0; i < points.size(); ++i)
    points(i) = static_cast<float>(random.uniform()) - 0.5F;
  points.col(0) = Eigen::Vector3f::UnitX();
  return points;
}

struct Told {
  std::vector<Vector6d> poses;
  std::vector<Eigen::Matrix4d> icp;
};

Told
runOn(const Eigen::Matrix3Xf& target, const Settings& settings)
{
  Eigen::Matrix3Xf source = target;
  source.row(1).array() += 0.03125F * target(0, 0);
  Told told;
  registerClouds(
      source,
      target,
      settings,
      [&told](const Progress& progress) {
        if (progress.steps > 0) // not while ICP runs
          told.poses.push_back(progress.pose);
        return true;
      },
      [&told](const Eigen::Matrix4d& T_target_source) {
        told.icp.push_back(T_target_source);
      });
  return told;
}

} // namespace

TEST(RegisterNormalized, TellsCallbacksInMetres)
{
  Settings settings;
  settings.options.preset = Preset::Paper;
  settings.options.paper.sgld.step_size = 1e-7;
  settings.options.paper.batch_size = 20;
  settings.options.chains.num_chains = 1;
  settings.options.chains.num_draws = 20;
  settings.options.chains.num_threads = 1;
  const Told plain = runOn(cloudOfUnitSize(), settings);

  settings.is_normalized = true;
  settings.options.prior.variance.head<3>() *= factor * factor;
  const Told scaled = runOn(factor * cloudOfUnitSize(), settings);

  ASSERT_EQ(plain.poses.size(), 20U);
  ASSERT_EQ(scaled.poses.size(), plain.poses.size());
  for (std::size_t i = 0; i < plain.poses.size(); ++i) {
    EXPECT_EQ(scaled.poses[i].head<3>(), (factor * plain.poses[i].head<3>()).eval());
    EXPECT_EQ(scaled.poses[i].tail<3>(), plain.poses[i].tail<3>());
  }
  ASSERT_GE(plain.icp.size(), 2U);
  ASSERT_EQ(scaled.icp.size(), plain.icp.size());
  for (std::size_t i = 0; i < plain.icp.size(); ++i) {
    Eigen::Matrix4d expected = plain.icp[i];
    expected.topRightCorner<3, 1>() *= factor;
    EXPECT_EQ(scaled.icp[i], expected);
  }
}

TEST(Register, TimeOfIcpIsThatOfAllItsIterations)
{
  Settings settings;
  settings.icp_iterations = 4;
  settings.options.preset = Preset::Paper;
  settings.options.paper.sgld.step_size = 1e-7;
  settings.options.chains.num_draws = 20;
  int num_calls = 0;
  const Eigen::Matrix3Xf cloud = cloudOfUnitSize();
  const std::chrono::milliseconds pause(20);
  const RegistrationResult result = registerClouds(
      cloud,
      cloud.colwise() + Eigen::Vector3f(0.05F, 0.02F, 0.0F),
      settings,
      [](const Progress&) { return true; },
      [&](const Eigen::Matrix4d&) {
        ++num_calls;
        std::this_thread::sleep_for(pause);
      });
  ASSERT_GE(num_calls, 3);
  // The first call is before ICP has begun.
  EXPECT_GE(result.icp_seconds,
            std::chrono::duration<double>((num_calls - 1) * pause).count());
  EXPECT_GT(result.sampling_seconds, 0.0);
}
