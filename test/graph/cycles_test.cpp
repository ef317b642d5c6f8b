// Closures of cycles of a graph whose errors are drawn from its covariances.
#include "graph/closed_cycles.h"
#include "graph/graph_support.h"
#include "graph/trajectory_files.h"
#include "io/errors.h"
#include "support/command_helpers.h"

#include <bayesian_icp/exports.h>
#include <bayesian_icp/measurement.h>

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <cmath>
#include <fstream>

using namespace bayesian_icp;
using namespace bayesian_icp::test;
using app::Closure;
using app::Cycle;
using app::GraphEdge;

TEST(Cycles, CloseWithinTheSumOfTheCovariances)
{
  constexpr int num_runs = 500;
  Random random(1, 0);
  double squared_error = 0.0;
  std::vector<app::ClosedCycle> closed;
  for (int run = 0; run < num_runs; ++run) {
    const auto poses = somePoses(4, random);
    // One edge of the path is backwards.
    const std::vector<GraphEdge> edges = {drawnEdge(poses, 0, 1, random),
                                          drawnEdge(poses, 2, 1, random),
                                          drawnEdge(poses, 2, 3, random),
                                          drawnEdge(poses, 0, 3, random)};
    const std::vector<Cycle> cycles = app::cyclesOf(edges, 4);
    ASSERT_EQ(cycles.size(), 1u);
    EXPECT_TRUE(app::cyclesOf(edges, 3).empty());
    const Closure closure = app::closureOf(edges, cycles[0]);
    EXPECT_EQ(closure.num_degrees, 6);
    squared_error += closure.squared_error / num_runs;
    closed.push_back(app::closedCycles(edges, 4).at(0));
  }
  EXPECT_NEAR(squared_error, 6.0, 4.0 * std::sqrt(12.0 / num_runs));
  const app::CycleStatistics all = app::statisticsOf(closed).back();
  EXPECT_EQ(all.num_cycles, num_runs);
  EXPECT_NEAR(all.nees_per_degree, squared_error / 6.0, 1e-9);
  EXPECT_NEAR(all.share_in_half, 0.5, 4.0 * std::sqrt(0.25 / num_runs));
  EXPECT_NEAR(all.share_in_95, 0.95, 4.0 * std::sqrt(0.95 * 0.05 / num_runs));
}

TEST(Cycles, TogetherAreChiSquareWhateverTheyHaveInCommon)
{
  constexpr int num_runs = 1500, num_poses = 8;
  constexpr app::SharedNoise shared{0.3, 0.1};
  Random random(6, 0);
  double squared_error = 0.0;
  int num_rare = 0, num_rare_if_independent = 0;
  for (int run = 0; run < num_runs; ++run) {
    const Poses poses = somePoses(num_poses, random);
    const std::vector<GraphEdge> edges = drawnSpan(poses, 3, shared, random);
    const auto cycles = app::closedCycles(edges, 4);
    const app::JointClosure joint = app::jointClosureOf(edges, cycles);
    // An edge more than the chain needs is a cycle more.
    ASSERT_EQ(joint.num_cycles, edges.size() - num_poses + 1);
    ASSERT_EQ(joint.num_degrees, 66);
    squared_error += joint.squared_error / num_runs;
    num_rare += joint.probability < 0.05 ? 1 : 0;
    double sum = 0.0;
    for (const app::ClosedCycle& closed : cycles)
      sum += closed.closure.squared_error;
    // 95 % quantile of chi-square with 66 degrees of freedom.
    num_rare_if_independent += sum > 85.965 ? 1 : 0;
  }
  EXPECT_NEAR(squared_error, 66.0, 4.0 * std::sqrt(2.0 * 66.0 / num_runs));
  const double tolerance = 4.0 * std::sqrt(0.05 * 0.95 * num_runs);
  EXPECT_NEAR(num_rare, 0.05 * num_runs, tolerance);
  EXPECT_GT(num_rare_if_independent, 0.05 * num_runs + tolerance);
}

TEST(Cycles, ThatAreSumsOfOthersAreNotCountedTogether)
{
  Random random(7, 0);
  const Poses poses = somePoses(4, random);
  std::vector<GraphEdge> edges;
  for (int target = 0; target < 4; ++target)
    for (int source = target + 1; source < 4; ++source)
      edges.push_back(drawnEdge(poses, target, source, random));
  auto cycles = app::closedCycles(edges, 4);
  ASSERT_EQ(cycles.size(), 3u);
  const double expected = app::jointClosureOf(edges, cycles).squared_error;
  // From 2 to 3, and back by 1: the fourth of four triangles.
  const Cycle fourth{5, {3, 4}};
  cycles.push_back({"2-1-3", fourth, app::closureOf(edges, fourth)});
  const app::JointClosure joint = app::jointClosureOf(edges, cycles);
  EXPECT_EQ(joint.num_cycles, 3u);
  EXPECT_EQ(joint.num_degrees, 18);
  // Any three of them say the same, to first order.
  cycles.erase(cycles.begin());
  EXPECT_NEAR(
      app::jointClosureOf(edges, cycles).squared_error, expected, 0.05 * expected);
}

TEST(Cycles, AreTheShortestAndEachIsThereOnce)
{
  Random random(2, 0);
  const auto poses = somePoses(5, random);
  std::vector<GraphEdge> edges;
  for (int k = 0; k < 4; ++k)
    edges.push_back(drawnEdge(poses, k, k + 1, random));
  for (int k = 0; k < 3; ++k)
    edges.push_back(drawnEdge(poses, k, k + 2, random));
  const std::vector<Cycle> cycles = app::cyclesOf(edges, 4);
  ASSERT_EQ(cycles.size(), 3u);
  for (const Cycle& cycle : cycles)
    EXPECT_EQ(cycle.path.size(), 2u);
}

TEST(Cycles, DoNotSeeWhatDrawsAllEdgesAlike)
{
  // Steps of 1, 2 and 3 m are a tenth too short: 100 deviations and more.
  const std::vector<GraphEdge> edges = {edgeAlongX(0, 1, 0.9, 1e-6),
                                        edgeAlongX(1, 2, 1.8, 1e-6),
                                        edgeAlongX(0, 2, 2.7, 1e-6)};
  const Closure closure = app::closureOf(edges, app::cyclesOf(edges, 3).at(0));
  EXPECT_LT(closure.squared_error, 1e-9);
}

TEST(Cycles, DoNotCountWhatNoCloudHasSeen)
{
  Random random(4, 0);
  const auto poses = somePoses(3, random);
  std::vector<GraphEdge> edges = {drawnEdge(poses, 0, 1, random),
                                  drawnEdge(poses, 1, 2, random),
                                  drawnEdge(poses, 0, 2, random)};
  edges[1].covariance(2, 2) += 30.0 * 30.0;
  const Closure closure = app::closureOf(edges, app::cyclesOf(edges, 3).at(0));
  EXPECT_EQ(closure.num_degrees, 5);
}

class GraphFile : public FolderTest {
protected:
  void
  write(const std::string& text) const
  {
    std::ofstream(file()) << text;
  }

  std::string
  file() const
  {
    return (folder_ / "graph.g2o").string();
  }
};

TEST_F(GraphFile, GivesBackWhatWasExported)
{
  Random random(5, 0);
  const Vector6d mean = randomPose(random, 0.5);
  const Matrix6d covariance = someCovariance(random);
  PoseEstimate estimate = estimateOf(mean, covariance, CovarianceConvention::RightSE3);
  estimate.status = Status::Ok;
  ExportOptions options;
  options.target_vertex = 3;
  options.source_vertex = 7;
  write("VERTEX_SE3:QUAT 3 0 0 0 0 0 0 1\nFIX 3\n\n" + g2oEdge(estimate, options));
  const std::vector<GraphEdge> edges = app::readGraph(file());
  ASSERT_EQ(edges.size(), 1u);
  EXPECT_EQ(edges[0].target, 3);
  EXPECT_EQ(edges[0].source, 7);
  EXPECT_TRUE(edges[0].T_target_source.isApprox(matrixOf(mean), 1e-12));
  EXPECT_TRUE(edges[0].covariance.isApprox(covariance, 1e-6));
}

TEST_F(GraphFile, IsRefusedWithTheLineThatIsWrong)
{
  const std::string pose = "EDGE_SE3:QUAT 0 1 0 0 0 0 0 0 1 ";
  const std::string good = "1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1";
  write(pose + good + '\n');
  EXPECT_NO_THROW(app::readGraph(file()));
  for (const std::string& bad : {pose + "1 2 3",
                                 pose + good + " 1",
                                 pose + "-" + good,
                                 pose + "nan" + good.substr(1),
                                 "EDGE_SE3:QUAT 0 1 0 0 0 0 0 0 2 " + good,
                                 "EDGE_SE3:QUAT 1 1 0 0 0 0 0 0 1 " + good}) {
    write("FIX 0\n" + bad + '\n');
    try {
      app::readGraph(file());
      ADD_FAILURE() << bad;
    }
    catch (const io::FileError& error) {
      EXPECT_NE(std::string(error.what()).find("line 2 "), std::string::npos)
          << error.what();
    }
  }
  write("FIX 0\n");
  EXPECT_THROW(app::readGraph(file()), io::FileError);
}

TEST(Edge, IsNoPosteriorThatMayBeInAnotherBasin)
{
  Summary summary;
  EXPECT_FALSE(app::complaintAboutEdge(summary).empty());
  summary.status = Status::Doubtful;
  summary.mean.setZero();
  summary.covariances.fill(Matrix6d::Identity());
  const auto isRefused = [&summary] {
    const std::string complaint = app::complaintAboutEdge(summary);
    EXPECT_TRUE(complaint.empty() ||
                complaint.find("another basin") != std::string::npos);
    return !complaint.empty();
  };
  summary.data.flags.misfit = true;
  EXPECT_FALSE(isRefused());
  summary.data.flags.low_support = true;
  EXPECT_TRUE(isRefused());
  summary.data.flags.misfit = false;
  EXPECT_FALSE(isRefused());
  summary.data.flags.wrong_basin = true;
  EXPECT_TRUE(isRefused());
}

TEST(SquareRoot, IsFiniteBesideAMotionThatNothingSees)
{
  // The deviation of a motion that the clouds do not see may be 100 m. A solver finds
  // some of the other eigenvalues below 0.
  Random random(31, 0);
  int num_negative = 0;
  for (int k = 0; k < 20; ++k) {
    const Vector6d unseen = 100.0 * random.normal6();
    const Matrix6d covariance =
        unseen * unseen.transpose() + 1e-14 * Matrix6d::Identity();
    num_negative +=
        Eigen::SelfAdjointEigenSolver<Matrix6d>(covariance).eigenvalues()[0] < 0.0;
    const Matrix6d root = app::squareRootOf(covariance);
    EXPECT_TRUE((root * root).isApprox(covariance, 1e-12)) << k;
  }
  EXPECT_GT(num_negative, 0);
}
