// Poses and covariances of optimised graphs against closed forms and known truths.
#include "graph/cycle_closure.h"
#include "graph/graph_support.h"
#include "graph/optimization.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

using namespace bayesian_icp;
using namespace bayesian_icp::test;
using app::GaussianPose;
using app::GraphEdge;
using app::OptimizedPoses;
using app::RobustLoss;

namespace {

/** As a tool has them before the optimisation. */
Poses
chained(const std::vector<GraphEdge>& edges, std::size_t count)
{
  Poses poses(1, Eigen::Matrix4d::Identity());
  for (std::size_t k = 0; k + 1 < count; ++k)
    poses.push_back(poses.back() * edges[k].T_target_source);
  return poses;
}

/** Of \p count poses, from the chain of the first edges on. */
OptimizedPoses
optimized(const std::vector<GraphEdge>& edges, std::size_t count)
{
  const OptimizedPoses found =
      optimizedPoses(chained(edges, count), edges, RobustLoss::None);
  EXPECT_EQ(found.complaint, "");
  return found;
}

/** Edges k to k + 1. */
std::vector<GraphEdge>
drawnChain(const Poses& poses, Random& random)
{
  std::vector<GraphEdge> edges;
  for (int k = 0; k + 1 < static_cast<int>(poses.size()); ++k)
    edges.push_back(drawnEdge(poses, k, k + 1, random));
  return edges;
}

/** The same, and back to 0. */
std::vector<GraphEdge>
drawnLoop(const Poses& poses, Random& random)
{
  std::vector<GraphEdge> edges = drawnChain(poses, random);
  edges.push_back(drawnEdge(poses, static_cast<int>(poses.size()) - 1, 0, random));
  return edges;
}

/** Twist from what was found to the truth, on the right. */
Vector6d
errorOf(const GaussianPose& found, const Eigen::Matrix4d& truth)
{
  return logSE3(matrixOf(found.mean).inverse() * truth);
}

double
relativeDifference(const Matrix6d& a, const Matrix6d& b)
{
  return (a - b).norm() / b.norm();
}

} // namespace

TEST(OptimizedPosesOf, AChainAreTheChainAndCovariancesAddUpAlongIt)
{
  Random random(1, 0);
  const Poses truth = somePoses(5, random);
  std::vector<GraphEdge> edges = drawnChain(truth, random);
  const Poses chain = chained(edges, 5);
  const OptimizedPoses found = optimized(edges, 5);
  ASSERT_EQ(found.poses.size(), 5u);
  EXPECT_EQ(found.poses[0].covariance, Matrix6d(Matrix6d::Zero()));
  for (std::size_t k = 1; k < 5; ++k) {
    EXPECT_LT(errorOf(found.poses[k], chain[k]).norm(), 1e-9);
    Matrix6d sum = Matrix6d::Zero();
    for (std::size_t i = 0; i < k; ++i) {
      // An error on the right of pose i + 1, carried to the right of pose k.
      const Matrix6d carry = app::adjointOf(chain[k].inverse() * chain[i + 1]);
      sum += carry * edges[i].covariance * carry.transpose();
    }
    EXPECT_LT(relativeDifference(found.poses[k].covariance, sum), 1e-6) << k;
  }
  for (const double squared_error : found.squared_errors)
    EXPECT_LT(squared_error, 1e-9);
}

TEST(OptimizedPosesOf, TwoParallelEdgesAreTheirMeanWeightedByInformation)
{
  Random random(2, 0);
  const Poses truth = somePoses(2, random);
  std::vector<GraphEdge> edges = {drawnEdge(truth, 0, 1, random),
                                  drawnEdge(truth, 0, 1, random)};
  const Vector6d between =
      logSE3(edges[0].T_target_source.inverse() * edges[1].T_target_source);
  const Matrix6d A = edges[0].covariance.inverse(), B = edges[1].covariance.inverse();
  const Matrix6d covariance = (A + B).inverse();
  const Eigen::Matrix4d mean =
      edges[0].T_target_source * expSE3(Vector6d(covariance * (B * between)));
  const OptimizedPoses found = optimized(edges, 2);
  // To second order in the difference of the edges.
  EXPECT_LT(errorOf(found.poses[1], mean).norm(), 0.01 * between.norm());
  EXPECT_LT(relativeDifference(found.poses[1].covariance, covariance), 0.02);
  const double expected =
      squaredError(between, edges[0].covariance + edges[1].covariance);
  EXPECT_NEAR(
      found.squared_errors[0] + found.squared_errors[1], expected, 0.01 * expected);
}

TEST(OptimizedPosesOf, AnEdgeThatLeavesARotationFreeLetsItGoAnyFar)
{
  // About an axis 2 m away, as of a round object. The other edge is exact.
  const Vector6d turn(0.0, -2.0, 0.0, 0.0, 0.0, 1.0);
  const Matrix6d tight = 1e-6 * Matrix6d::Identity();
  for (const double angle : {0.35, 1.2, 2.0, 3.0}) {
    GraphEdge measured, free;
    measured.source = free.source = 1;
    measured.covariance = 1e-3 * Matrix6d::Identity();
    free.T_target_source = expSE3(Vector6d(angle * turn));
    free.covariance = tight + 1e3 * turn * turn.transpose();
    const OptimizedPoses found = optimized({measured, free}, 2);
    // The free motion's own information is 1e-3.
    EXPECT_LT(errorOf(found.poses[1], Eigen::Matrix4d::Identity()).norm(), 1e-3 * angle)
        << angle;
    EXPECT_LT(found.squared_errors[1], 2e-3 * angle * angle) << angle;
  }
}

TEST(OptimizedPosesOf, LoopsAreAsFarFromTheTruthAsTheirCovariancesSay)
{
  constexpr int num_runs = 300;
  Random random(3, 0);
  double of_poses = 0.0, of_edges = 0.0, of_chain = 0.0;
  for (int run = 0; run < num_runs; ++run) {
    const Poses truth = somePoses(5, random);
    const std::vector<GraphEdge> edges = drawnLoop(truth, random);
    const Poses chain = chained(edges, 5);
    const OptimizedPoses found = optimized(edges, 5);
    of_poses += squaredErrorOf(found.poses[4], truth[4]) / num_runs;
    for (const double squared_error : found.squared_errors)
      of_edges += squared_error / num_runs;
    of_chain += errorOf({poseOf(chain[4]), {}}, truth[4]).squaredNorm() /
                errorOf(found.poses[4], truth[4]).squaredNorm() / num_runs;
  }
  // A chi-square of 6 degrees each: 30 residuals, 24 unknowns.
  const double tolerance = 4.0 * std::sqrt(12.0 / num_runs);
  EXPECT_NEAR(of_poses, 6.0, tolerance);
  EXPECT_NEAR(of_edges, 6.0, tolerance);
  EXPECT_GT(of_chain, 2.0);
}

TEST(OptimizedPosesOf, EdgesThatShareNoiseAreAsFarOffAsStated)
{
  constexpr int num_runs = 100, num_poses = 16;
  constexpr app::SharedNoise shared{0.25, 0.1}, without_common{0.25, 0.0};
  Random random(7, 0);
  double as_drawn = 0.0, without = 0.0, alone = 0.0;
  for (int run = 0; run < num_runs; ++run) {
    const Poses truth = steadyPoses(num_poses);
    std::vector<GraphEdge> edges = drawnSpan(truth, 3, shared, random);
    const auto lastPoseFor = [&](const app::SharedNoise& assumed) {
      for (GraphEdge& edge : edges)
        edge.shared = assumed;
      const OptimizedPoses found = optimizedPoses(truth, edges, RobustLoss::None);
      EXPECT_EQ(found.complaint, "");
      return found.poses.back();
    };
    const auto squaredErrorFor = [&](const app::SharedNoise& assumed) {
      return squaredErrorOf(lastPoseFor(assumed), truth.back());
    };
    const GaussianPose with_common = lastPoseFor(shared);
    as_drawn += squaredErrorOf(with_common, truth.back()) / num_runs;
    without += squaredErrorFor(without_common) / num_runs;
    alone += squaredErrorFor(app::independent_noise) / num_runs;
    if (run == 0) {
      // The common noise has no part in the weights.
      const double scale = 1.0 / (1.0 - shared.common);
      const GaussianPose without_weight = lastPoseFor({shared.scan * scale, 0.0});
      EXPECT_LT((without_weight.mean - with_common.mean).norm(), 1e-6);
    }
  }
  EXPECT_NEAR(as_drawn, 6.0, 4.0 * std::sqrt(12.0 / num_runs));
  EXPECT_GT(without, 7.5);
  EXPECT_GT(alone, 9.0);
}

TEST(OptimizedPosesOf, WhatAllEdgesHaveInCommonAddsUpAlongAChain)
{
  // Ten steps along x, each off by 1 mm: 9 parts in 10 each for itself, one in 10
  // alike.
  std::vector<GraphEdge> edges;
  for (int k = 0; k < 10; ++k) {
    edges.push_back(edgeAlongX(k, k + 1, 1.0, 1e-6));
    edges.back().shared = {0.0, 0.1};
  }
  const OptimizedPoses found = optimized(edges, 11);
  EXPECT_NEAR(found.poses[10].mean[0], 10.0, 1e-9);
  EXPECT_NEAR(found.poses[10].covariance(0, 0),
              1e-6 * (0.9 * 10.0 + 0.1 * 100.0),
              1e-6 * 19.0 * 1e-3);
  for (const double squared_error : found.squared_errors)
    EXPECT_LT(squared_error, 1e-9);
}

TEST(OptimizedPosesOf, AGraphWithAWrongEdgeHardlyMoveWithARobustLoss)
{
  Random random(4, 0);
  const Poses truth = somePoses(8, random);
  std::vector<GraphEdge> edges = drawnLoop(truth, random);
  for (int k = 0; k + 2 < 8; ++k)
    edges.push_back(drawnEdge(truth, k, k + 2, random));
  const Poses chain = chained(edges, 8);
  const OptimizedPoses right = optimized(edges, 8);
  GraphEdge wrong = drawnEdge(truth, 1, 6, random);
  wrong.T_target_source(0, 3) += 1.0;
  edges.push_back(wrong);
  const auto movedBy = [&](RobustLoss loss) {
    const OptimizedPoses found = optimizedPoses(chain, edges, loss);
    EXPECT_EQ(found.complaint, "");
    EXPECT_GT(found.squared_errors.back(), 100.0);
    return errorOf(found.poses[6], matrixOf(right.poses[6].mean)).head<3>().norm();
  };
  const double by_none = movedBy(RobustLoss::None);
  const double by_huber = movedBy(RobustLoss::Huber);
  const double by_cauchy = movedBy(RobustLoss::Cauchy);
  const double deviation =
      std::sqrt(right.poses[6].covariance.topLeftCorner<3, 3>().trace());
  EXPECT_GT(by_none, 10.0 * deviation);
  EXPECT_LT(by_huber, 0.5 * by_none);
  EXPECT_LT(by_cauchy, 0.2 * deviation);
}

TEST(OptimizedPosesOf, AnEdgePullsNoHarderThanAtItsBorder)
{
  // Three edges, one wrong, join two poses: two of 1 m and one of 11 m, all with
  // deviations of 0.1 m. Huber's loss lets the wrong one pull as one would that is as
  // far off as the border of its 95 % region, 3.548 deviations.
  for (const app::SharedNoise& shared :
       {app::independent_noise, app::SharedNoise{0.3, 0.0}, app::SharedNoise()}) {
    const GraphEdge right = edgeAlongX(0, 1, 1.0, 0.01);
    GraphEdge wrong = edgeAlongX(0, 1, 11.0, 0.01);
    wrong.shared = shared;
    const std::vector<GraphEdge> edges = {right, right, wrong};
    const OptimizedPoses found =
        optimizedPoses(chained({right}, 2), edges, RobustLoss::Huber);
    EXPECT_EQ(found.complaint, "");
    EXPECT_NEAR(
        found.poses[1].mean[0], 1.0 + 0.05 * 3.548 / (1.0 - shared.common), 0.001)
        << shared.scan << ' ' << shared.common;
  }
}

TEST(DisagreementsOf, AnEdgeThatPullsThePosesAlongShowsInItsCycles)
{
  // Five poses a metre apart, edges to the first and second before, all with deviations
  // of 0.1 m and no error but one of 0.85 m. That leaves 0.85^2 / 0.1^2 / 3 = 24 in
  // each of its two cycles (99 % quantile: 16.8), but only half of the error against
  // the optimum.
  std::vector<GraphEdge> edges;
  for (int source = 1; source < 5; ++source)
    for (int target = std::max(0, source - 2); target < source; ++target)
      edges.push_back(edgeAlongX(target, source, source - target, 0.01));
  const auto disagreements = [&edges] {
    Poses poses(5, Eigen::Matrix4d::Identity());
    return disagreementsOf(app::closedCycles(edges, edges.size() + 1),
                           optimizedPoses(poses, edges, RobustLoss::None));
  };
  EXPECT_TRUE(disagreements().empty());
  const std::size_t wrong = 2; // from 1 to 2
  ASSERT_EQ(edges[wrong].target, 1);
  edges[wrong].T_target_source(0, 3) += 0.85;
  const std::vector<app::Disagreement> found = disagreements();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].edge, wrong);
  EXPECT_FALSE(app::isContradiction(found[0].squared_error));
  EXPECT_EQ(found[0].num_open_cycles, 2U);
}

TEST(OptimizedPosesOf, GraphsThatAreNoneAreRefused)
{
  Random random(5, 0);
  const Poses truth = somePoses(4, random);
  std::vector<GraphEdge> edges = drawnChain(truth, random);
  const auto messageOf = [&] {
    try {
      optimizedPoses(truth, edges, RobustLoss::None);
    }
    catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(messageOf(), "");
  edges[2].source = 4;
  EXPECT_EQ(messageOf(), "vertex 4 has no pose");
  edges[2] = drawnEdge(truth, 3, 2, random);
  edges[2].covariance(0, 0) = -1.0;
  EXPECT_EQ(messageOf(), "the covariance of edge 3-2 is not positive definite");
  edges.pop_back();
  EXPECT_EQ(messageOf(), "no edges join scan 3 to scan 0");
}

TEST(OptimizedPosesOf, OneScanIsWhereItIs)
{
  const OptimizedPoses found =
      app::optimizedPoses({Eigen::Matrix4d::Identity()}, {}, RobustLoss::None);
  EXPECT_EQ(found.complaint, "");
  ASSERT_EQ(found.poses.size(), 1u);
  EXPECT_LT(found.poses[0].mean.norm(), 1e-15);
}

TEST(Way, AlongAChainHasTheCovarianceThatTheOptimisationFinds)
{
  Random random(6, 0);
  const Poses truth = somePoses(4, random);
  std::vector<GraphEdge> edges = drawnChain(truth, random);
  const OptimizedPoses found = optimized(edges, 4);
  const app::Way way = app::wayAlong(edges, 0, {0, 1, 2});
  EXPECT_EQ(way.end, 3);
  EXPECT_LT(errorOf(found.poses[3], way.T_begin_end).norm(), 1e-9);
  EXPECT_LT(relativeDifference(found.poses[3].covariance, way.covariance()), 1e-6);
  // And back to where it began.
  const app::Way there_and_back = app::wayAlong(edges, 0, {0, 1, 1, 0});
  EXPECT_EQ(there_and_back.end, 0);
  EXPECT_TRUE(there_and_back.T_begin_end.isIdentity(1e-12));
}

namespace {

std::vector<GaussianPose>
posesAlongX(const std::vector<double>& positions)
{
  std::vector<GaussianPose> poses;
  for (const double x : positions) {
    poses.emplace_back();
    poses.back().mean[0] = x;
  }
  return poses;
}

} // namespace

TEST(LoopCandidates, AreNearestPosesFromBeforeTheSensorWasAway)
{
  using Pairs = std::vector<std::pair<int, int>>;
  const auto poses = posesAlongX({0.0, 0.5, 1.0, 2.0, 3.0, 1.2, 0.6, 0.55});
  EXPECT_EQ(app::loopCandidates(poses, 0.7), (Pairs{{2, 5}, {1, 6}, {1, 7}}));
  EXPECT_EQ(app::loopCandidates(poses, 0.1), (Pairs{{1, 6}, {1, 7}}));
}

TEST(LoopCandidates, AreNotMadeOfNeighboursInTheSequence)
{
  EXPECT_TRUE(
      app::loopCandidates(posesAlongX({0.0, 0.1, 0.2, 0.3, 0.4, 0.5}), 0.4).empty());
  EXPECT_TRUE(app::loopCandidates(posesAlongX({0.0, 0.1, 0.0, 0.1, 0.0}), 0.2).empty());
}
