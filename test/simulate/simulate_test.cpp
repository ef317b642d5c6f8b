/** \file
 * \brief The scenes of the scan simulator and the pairs of scans: are the points on the
 * surfaces, in the right frames?
 */
#include "simulate/simulate_helpers.h"

#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

using namespace bayesian_icp;
using namespace bayesian_icp::simulator;
using Eigen::Vector3d;

namespace {

class EveryScene : public testing::TestWithParam<std::string> {};

} // namespace

TEST_P(EveryScene, DistanceNeverReachesBeyondASurface)
{
  const Scene scene = makeScene(GetParam());
  const SimulationOptions options = defaultOptions(GetParam());
  const Vector3d eye = options.target_view.eye;
  // Scenes to drive through are wider than the eye is high.
  const double spread = options.sensor.max_range > 50.0 ? 8.0 : 0.2 * eye.norm();
  Random random(1, 0);
  const auto normals = [&random] {
    return Vector3d(random.normal(), random.normal(), random.normal());
  };
  for (int trial = 0; trial < 20000; ++trial) {
    const Vector3d point = eye * random.uniform() + spread * normals();
    const double distance = scene.distance(point);
    if (distance <= 0.0)
      continue;
    // In any direction, and by all of the distance straight towards the surface.
    const Vector3d aside = random.uniform() * distance * normals().normalized();
    const Vector3d towards = -distance * scene.surfaceNormal(point);
    EXPECT_GE(scene.distance(point + aside), -1e-12) << point.transpose();
    EXPECT_GE(scene.distance(point + towards), -1e-9) << point.transpose();
  }
}

TEST_P(EveryScene, CleanPointsLieOnTheSurfaceInBothFrames)
{
  for (const CloudFrame frame : {CloudFrame::Object, CloudFrame::Sensor}) {
    SimulationOptions options = cleanOptions(GetParam());
    options.frame = frame;
    options.offset << 0.05, -0.03, 0.02, 0.1, -0.2, 0.3;
    const Scene scene = makeScene(GetParam());
    const ScanPair pair = simulate(options);
    const Eigen::Isometry3d T_world_target(pair.T_target_world.inverse());
    const Eigen::Isometry3d T_target_source(pair.T_target_source);
    const Eigen::Matrix3Xd target = T_world_target * pair.target.cast<double>();
    const Eigen::Matrix3Xd source =
        T_world_target * T_target_source * pair.source.cast<double>();
    ASSERT_GT(target.cols(), 200);
    ASSERT_GT(source.cols(), 200);
    for (const Eigen::Matrix3Xd& cloud : {target, source})
      for (const Vector3d point : cloud.colwise())
        ASSERT_LT(std::abs(scene.distance(point)), 1e-4);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes,
                         EveryScene,
                         testing::ValuesIn(sceneNames()),
                         [](const auto& test) { return test.param; });

TEST(SimulatedScenes, HaveTheirStatedSizes)
{
  EXPECT_NEAR(makeScene("can").distance({0.1, 0.0, 0.0}), 0.1 - 0.033, 1e-15);
  EXPECT_NEAR(makeScene("can").distance({0.03, 0.0, 0.1}), 0.04, 1e-15);
  EXPECT_NEAR(makeScene("mug").distance({0.0, -0.1, 0.0}), 0.06, 1e-15);
  EXPECT_NEAR(makeScene("mug").distance({0.1, 0.0, 0.0}), 0.1 - 0.075, 1e-15);
  EXPECT_NEAR(makeScene("mug").distance({0.0, 0.0, 0.0}), 0.036, 1e-15);
  EXPECT_NEAR(makeScene("bowl").distance({0.0, 0.0, -0.138}), 0.1, 1e-15);
  EXPECT_NEAR(makeScene("bowl").distance({0.0826, 0.0, 0.138}), 0.1, 1e-8);
  EXPECT_NEAR(makeScene("bowl").distance({0.2, 0.0, 0.0355}), 0.2 - 0.0851136, 1e-6);
  EXPECT_NEAR(makeScene("table_top").distance({0.7, 0.0, -0.01}), 0.1, 1e-15);
  EXPECT_NEAR(makeScene("table_plate").distance({0.6, 0.0, -0.01}), 0.1, 1e-15);
  EXPECT_NEAR(makeScene("corridor").distance({0.75, 0.3, 1.2}), 0.7, 1e-15);
  EXPECT_NEAR(makeScene("corridor").distance({-1.5, 0.3, 1.2}), 0.64, 1e-15);
  EXPECT_NEAR(makeScene("stairs").distance({0.42, 0.0, 0.4}), 0.06, 1e-15);
  EXPECT_NEAR(makeScene("plain_corridor").distance({0.75, 0.3, 1.2}), 0.7, 1e-15);
  EXPECT_NEAR(makeScene("cube").distance({0.0, 0.0, 0.2}), 0.1, 1e-15);
  EXPECT_NEAR(makeScene("cube").distance({0.5, 0.0, 0.03}), 0.03, 1e-15);
  EXPECT_NEAR(makeScene("box").distance({0.0, -0.3, 0.07}), 0.2, 1e-15);
  EXPECT_NEAR(makeScene("carton").distance({0.0, 0.0, 0.1}), 0.071, 1e-15);
  EXPECT_NEAR(makeScene("carton").distance({0.0, 0.0, 0.02}), 0.015, 1e-15);
  EXPECT_NEAR(makeScene("bracket").distance({0.0, 0.0, 0.046}), 0.034, 1e-15);
  EXPECT_NEAR(makeScene("bracket").distance({0.0, -0.03, 0.046}), 0.04, 1e-15);
  EXPECT_NEAR(makeScene("tool").distance({0.07, -0.1, 0.02}), 0.055, 1e-15);
  EXPECT_NEAR(makeScene("tool").distance({0.0, 0.0, 0.05}), 0.025, 1e-15);
  EXPECT_NEAR(makeScene("car").distance({0.0, 0.0, 2.0}), 0.55, 1e-15);
  EXPECT_NEAR(makeScene("car").distance({3.2, 0.0, 1.5}), std::hypot(1.0, 0.7), 1e-15);
  EXPECT_NEAR(makeScene("car").distance({2.0, 0.0, 1.5}), 0.7, 1e-15);
  EXPECT_NEAR(makeScene("car").distance({1.35, 0.0, 0.2}), 0.1, 1e-15);
  EXPECT_NEAR(makeScene("car").distance({1.35, 0.5, 0.2}), 0.1, 1e-15);
  EXPECT_NEAR(makeScene("tree").distance({0.0, 1.0, 2.0}), 0.8, 1e-15);
  EXPECT_NEAR(makeScene("tunnel").distance({7.0, 3.0, 1.5}), 1.5, 1e-15);
  EXPECT_NEAR(makeScene("office_floor").distance({2.0, 0.5, 1.0}), 0.7, 1e-15);
  EXPECT_NEAR(makeScene("office_floor").distance({0.0, 1.26, 1.0}), 0.45, 1e-15);
  EXPECT_THROW(makeScene("moon"), std::invalid_argument);
}

TEST(SimulatedScenes, ShowTheHandleOfTheMugOrHideIt)
{
  for (const std::string name : {"mug", "mug_hidden_handle"}) {
    const Scene scene = makeScene(name);
    const ScenePart &body = scene.parts.at(0), &handle = scene.parts.at(1);
    SimulationOptions options = defaultOptions(name);
    options.sensor.noise = 0.0;
    options.offset.setZero();
    const ScanPair pair = simulate(options);
    for (const Eigen::Matrix3Xf* cloud : {&pair.source, &pair.target}) {
      int handle_points = 0;
      for (const Eigen::Vector3f single : cloud->colwise()) {
        const Vector3d point = single.cast<double>();
        handle_points += handle.distance(point) < body.distance(point);
      }
      if (name == "mug")
        EXPECT_GT(handle_points, cloud->cols() / 20);
      else
        EXPECT_EQ(handle_points, 0);
    }
  }
}

TEST(SimulatedScenes, TableTopShowsNoEdge)
{
  SimulationOptions options = cleanOptions("table_top");
  options.offset.setZero();
  const ScanPair pair = simulate(options);
  for (const Eigen::Matrix3Xf* cloud : {&pair.source, &pair.target}) {
    EXPECT_EQ(cloud->cols(), 160 * 120) << "a ray passes the table";
    EXPECT_LT(cloud->row(2).cwiseAbs().maxCoeff(), 1e-5F) << "a side is seen";
  }
}

TEST(SimulatedPairs, OverlapAtTheTrueTransform)
{
  for (const std::string name : {"bowl", "can", "mug", "mug_hidden_handle", "table"}) {
    const ScanPair pair = simulate(cleanOptions(name));
    const auto overlap = [&pair](const Eigen::Matrix4d& T, float within) {
      const Eigen::Matrix3Xf moved = Eigen::Isometry3f(T.cast<float>()) * pair.source;
      int near = 0;
      for (Eigen::Index i = 0; i < moved.cols(); ++i)
        near +=
            (pair.target.colwise() - moved.col(i)).colwise().norm().minCoeff() < within;
      return static_cast<double>(near) / static_cast<double>(moved.cols());
    };
    // Two pixels of the reduced image at the distance of the object.
    const double distance = defaultOptions(name).target_view.eye.norm();
    const auto within =
        static_cast<float>(2.0 * distance * std::tan(28.5 * degree) / 80.0);
    EXPECT_GT(overlap(pair.T_target_source, within), 0.7) << name;
    EXPECT_LT(overlap(pair.T_target_source, 0.001F), 0.7) << name << ": the same scan";
    EXPECT_LT(overlap(Eigen::Matrix4d::Identity(), within), 0.7) << name;
  }
}

TEST(SimulatedPairs, FollowTheSeed)
{
  SimulationOptions camera = cleanOptions("mug");
  camera.sensor.noise = 1.0;
  camera.sensor.jitter = 1.0;
  SimulationOptions lidar = cleanOptions("street");
  lidar.sensor.noise = 1.0;
  lidar.sweep_motion = 1.0;
  for (SimulationOptions options : {camera, lidar}) {
    const ScanPair first = simulate(options);
    const ScanPair again = simulate(options);
    EXPECT_TRUE(first.source == again.source && first.target == again.target);
    options.seed = 2;
    const ScanPair other = simulate(options);
    EXPECT_FALSE(first.source.cols() == other.source.cols() &&
                 first.source == other.source);
  }
}

TEST(SimulatedPairs, InTheObjectFrameTheOffsetIsTheTruth)
{
  SimulationOptions options = cleanOptions("can");
  options.offset << 0.1, 0.2, -0.3, 0.4, -0.5, 0.6;
  EXPECT_TRUE(
      simulate(options).T_target_source.isApprox(matrixOf(options.offset), 1e-15));
}
