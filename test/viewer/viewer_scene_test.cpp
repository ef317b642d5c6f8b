// What the viewer decides to show: layers, draws, legend, traces of running chains.
#include "viewer/legend.h"
#include "viewer/live_state.h"
#include "viewer/scene.h"

#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <cmath>

namespace bayesian_icp::viewer {
namespace {

/** A stick of 0.9 m along x that may turn about z: sd of yaw is \p yaw_deviation. */
Scene
stick(double yaw_deviation)
{
  Scene scene;
  scene.source = Eigen::Matrix3Xd::Zero(3, 10);
  scene.source.row(0).setLinSpaced(0.0, 0.9);
  scene.target = scene.source;
  scene.num_target_points = 11;
  Random random(1, 1);
  scene.draws = PoseMatrix::Zero(400, 6);
  for (Eigen::Index i = 0; i < scene.draws.rows(); ++i)
    scene.draws(i, 5) = yaw_deviation * random.normal();
  return scene;
}

TEST(Scene, ShowsTheDrawsAskedFor)
{
  ViewOptions options;
  options.num_draws = 7;
  const auto uncertainty = uncertaintyOf(stick(0.001), options);
  ASSERT_TRUE(uncertainty);
  EXPECT_EQ(uncertainty->shown_draws.size(), 7U);
  // The stick's 0.9 m end moves by about 0.9 mm: 50 times that is a twentieth of 0.9 m.
  EXPECT_GE(uncertainty->magnification, 20.0);
  EXPECT_LE(uncertainty->magnification * uncertainty->point_deviations.maxCoeff(),
            0.045);
  options.magnification = 3.0;
  EXPECT_EQ(uncertaintyOf(stick(0.001), options)->magnification, 3.0);
}

TEST(Scene, MagnificationMakesDeviationsATwentiethAtMost)
{
  EXPECT_EQ(niceMagnification(0.001, 1.0), 50.0);
  EXPECT_EQ(niceMagnification(0.2, 1.0), 1.0);
  EXPECT_EQ(niceMagnification(0.0, 1.0), 1000.0);
}

TEST(Scene, ReferenceIsTheCentroidOrTheOrigin)
{
  ViewOptions options;
  const Scene scene = stick(0.001);
  EXPECT_NEAR(uncertaintyOf(scene, options)->spread.reference.x(), 0.45, 1e-7);
  options.reference = Reference::Origin;
  const auto at_origin = uncertaintyOf(scene, options);
  EXPECT_LT(at_origin->spread.positionDeviations()[0], 1e-12);
}

TEST(Scene, WithoutDrawsThereIsNoUncertainty)
{
  Scene scene = stick(0.1);
  scene.draws.conservativeResize(1, 6);
  EXPECT_FALSE(uncertaintyOf(scene, ViewOptions()));
  const auto panels = ViewOptions().panels(false);
  EXPECT_EQ(panels[0].layers, (Layers{Layer::Target, Layer::Aligned}));
}

TEST(Scene, PictureHoldsWhatTheLayersShow)
{
  Scene scene = stick(0.1);
  scene.guess(1, 3) = 5.0;
  EXPECT_EQ(shownPoints(scene, {Layer::Target}).cols(), 20);
  EXPECT_NEAR(shownPoints(scene, {Layer::Source}).row(1).maxCoeff(), 5.0, 1e-12);
  scene.uncertainty = uncertaintyOf(scene, ViewOptions());
  const Eigen::Matrix3Xd points = shownPoints(scene, {Layer::Rotation});
  // The cone of z: half the stick, from its centroid.
  EXPECT_NEAR(points.row(2).maxCoeff(), 0.45, 1e-6);
}

TEST(Scene, DrawsAreThinnedToWhatIsAllowed)
{
  ViewOptions options;
  options.num_draws = 5;
  Scene scene = stick(0.1);
  scene.uncertainty = uncertaintyOf(scene, options);
  EXPECT_EQ(pointsAtDraws(scene, 1000).cols(), 5 * 10);
  EXPECT_LE(pointsAtDraws(scene, 15).cols(), 15);
}

TEST(Panels, MultiviewHasOneAQuestion)
{
  ViewOptions options;
  options.is_multiview = true;
  EXPECT_EQ(options.panels(true).size(), 4U);
  for (const Panel& panel : options.panels(false))
    EXPECT_EQ(panel.layers.lower_bound(Layer::Deviation), panel.layers.end());
}

TEST(Legend, HasUnitsAndTheMagnification)
{
  ViewOptions options;
  options.num_draws = 5;
  Scene scene = stick(0.001);
  scene.uncertainty = uncertaintyOf(scene, options);
  const Panel panel{"title",
                    {Layer::Target, Layer::Draws, Layer::Position, Layer::Rotation}};
  const auto lines = legendOf(panel, scene, options, true);
  ASSERT_EQ(lines.size(), 6U);
  EXPECT_EQ(lines[0].text, "title");
  EXPECT_EQ(lines[1].text, "[t] target (11 points)");
  EXPECT_EQ(lines[2].text, "[d] source at 5 of 400 draws");
  EXPECT_NE(lines[3].text.find("95 % (3 dof)"), std::string::npos);
  EXPECT_NE(lines[3].text.find(" mm"), std::string::npos);
  EXPECT_NE(lines[4].text.find(" deg"), std::string::npos);
  EXPECT_NE(lines[5].text.find("times as large"), std::string::npos);
  // Bright text on a dark ground, and the other way round.
  EXPECT_EQ(lines[0].color, (Color{1.0, 1.0, 1.0}));
  options.background = {1.0, 1.0, 1.0};
  EXPECT_EQ(legendOf(panel, scene, options, true)[0].color, (Color{}));
}

TEST(Legend, StatusFollowsTheNote)
{
  Scene scene;
  scene.status_text = "ok: mixed";
  ASSERT_EQ(statusOf(scene, ViewOptions()).size(), 1U);
  scene.note = "warning: of two runs";
  const auto lines = statusOf(scene, ViewOptions());
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].text, "warning: of two runs");
  EXPECT_EQ(lines[1].text, "ok: mixed");
}

TEST(Legend, LinesThatAreTooLongGoOnBelow)
{
  const Color red{1.0, 0.0, 0.0};
  const auto lines = wrapped({{"mug", {}}, {"rotation, 95 %: cones", red}}, 16);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[1].text, "rotation, 95 %:");
  EXPECT_EQ(lines[2].text, "    cones");
  EXPECT_EQ(lines[2].color, red);
}

TEST(Legend, WritesLengthsAndAngles)
{
  EXPECT_EQ(textOfLengths({0.0123, 0.001, 2e-5}), "12.3, 1, 0.02 mm");
  EXPECT_EQ(textOfLengths({1.234, 0.5, 0.0}), "1.23, 0.5, 0 m");
  EXPECT_EQ(textOfAngles({std::acos(0.0), std::acos(-1.0) / 180.0, 0.0}),
            "90, 1, 0 deg");
}

TEST(Keys, AreAllDifferentAndNotPclViewers)
{
  const std::string taken = "pwsjcfeq+-guorlhxk0123456789";
  std::string own;
  for (const LayerName& name : layer_names) {
    EXPECT_EQ(taken.find(name.key), std::string::npos) << name.key;
    EXPECT_EQ(own.find(name.key), std::string::npos) << name.key;
    EXPECT_EQ(&nameOf(name.layer), &name);
    own += name.key;
  }
}

Progress
stepOf(int chain, long step, double x)
{
  Vector6d pose = Vector6d::Zero();
  pose[0] = x;
  return {chain, step, step, 10, pose};
}

TEST(LiveState, FollowsIcpAndChains)
{
  LiveState state({0.0, 1.0, 0.0});
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  state.moveIcp(matrix);
  EXPECT_EQ(state.snapshot().icp_iterations, 0);
  matrix(0, 3) = 2.0;
  state.moveIcp(matrix);
  EXPECT_EQ(state.snapshot().icp_iterations, 1);
  EXPECT_EQ(state.snapshot().icp_matrix, matrix);

  EXPECT_TRUE(state.moveChain({0, 0, 0, 0}));
  EXPECT_TRUE(state.snapshot().chains.empty());
  EXPECT_TRUE(state.moveChain(stepOf(1, 1, 0.25)));
  const LiveSnapshot snapshot = state.snapshot();
  ASSERT_EQ(snapshot.chains.size(), 2U);
  EXPECT_TRUE(snapshot.chains[0].trace.empty());
  ASSERT_EQ(snapshot.chains[1].trace.size(), 1U);
  EXPECT_EQ(snapshot.chains[1].trace[0], Eigen::Vector3d(0.25, 1.0, 0.0));
  EXPECT_EQ(snapshot.total_steps, 10);
  state.stop();
  EXPECT_FALSE(state.moveChain(stepOf(1, 2, 0.25)));
}

TEST(LiveState, KeepsTracesShortAndEvenlySpaced)
{
  LiveState state(Eigen::Vector3d::Zero());
  for (long step = 1; step <= 5000; ++step)
    state.moveChain(stepOf(0, step, static_cast<double>(step)));
  const ChainTrack track = state.snapshot().chains[0];
  EXPECT_LE(track.trace.size(), max_trace_length);
  EXPECT_GE(track.trace.size(), max_trace_length / 2);
  for (std::size_t i = 0; i < track.trace.size(); ++i)
    EXPECT_EQ(track.trace[i].x(),
              static_cast<double>((static_cast<long>(i) + 1) * track.steps_between));
}

} // namespace
} // namespace bayesian_icp::viewer
