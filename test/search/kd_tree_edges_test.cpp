// KdTree at the edges: gates, nothing to find, numbers that are not finite or huge.
#include "search/kd_tree_test_support.h"

#include <bayesian_icp/kd_tree.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace bayesian_icp::test {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

TEST_P(KdTreePath, GateIsInclusive)
{
  Random random(3, 0);
  const Eigen::Matrix3Xf points = uniformPoints(random, 500);
  const KdTree tree = treeOf(points);
  const Eigen::Vector3f query(0.3f, 0.4f, 2.f);
  const KdTree::Neighbor nearest = tree.nearest(query, infinity);
  for (const std::uint32_t hint : {KdTree::none, nearest.index, 7u}) {
    const float exact = nearest.squared_distance;
    EXPECT_TRUE(isSame(tree.nearest(query, exact, hint), nearest));
    EXPECT_TRUE(isNone(tree.nearest(query, std::nextafter(exact, 0.f), hint)));
    EXPECT_TRUE(isNone(tree.nearest(query, 0.f, hint)));
    EXPECT_TRUE(isNone(tree.nearest(query, -1.f, hint)));
    EXPECT_TRUE(isNone(tree.nearest(query, nan, hint)));
    EXPECT_EQ(tree.nearest(points.col(7), 0.f, hint).index, 7u);
  }
}

TEST_P(KdTreePath, EmptyCloudHasNoNeighbor)
{
  const KdTree tree = treeOf(Eigen::Matrix3Xf(3, 0));
  EXPECT_EQ(tree.size(), 0u);
  EXPECT_TRUE(isNone(tree.nearest(Eigen::Vector3f::Zero(), infinity)));
  EXPECT_TRUE(isNone(tree.nearest(Eigen::Vector3f::Zero(), infinity, 0)));
}

TEST_P(KdTreePath, NonFiniteColumnsAreNeverFound)
{
  Random random(4, 0);
  Eigen::Matrix3Xf points = uniformPoints(random, 300);
  for (Eigen::Index i = 0; i < 300; i += 3)
    points(i % 2, i) = i % 4 == 0 ? nan : i % 4 == 1 ? infinity : -infinity;
  const KdTree tree = treeOf(points);
  EXPECT_EQ(tree.size(), 200u);
  for (std::uint32_t hint = 0; hint < 300; ++hint) {
    const Eigen::Vector3f query = uniformPoints(random, 1);
    ASSERT_TRUE(isSame(tree.nearest(query, infinity, hint),
                       bruteForce(points, query, infinity)));
  }
  const KdTree nothing = treeOf(Eigen::Matrix3Xf::Constant(3, 40, nan));
  EXPECT_TRUE(isNone(nothing.nearest(Eigen::Vector3f::Zero(), infinity, 3)));
}

TEST_P(KdTreePath, NonFiniteQueryHasNoNeighbor)
{
  Random random(5, 0);
  const KdTree tree = treeOf(uniformPoints(random, 100));
  for (const float coordinate : {nan, infinity, -infinity})
    for (int axis = 0; axis < 3; ++axis)
      for (const std::uint32_t hint : {KdTree::none, 5u})
        EXPECT_TRUE(isNone(
            tree.nearest(coordinate * Eigen::Vector3f::Unit(axis), infinity, hint)));
}

TEST_P(KdTreePath, HugeCoordinatesAreSearchedAndOverflowIsBeyondEveryGate)
{
  Random random(6, 0);
  const Eigen::Matrix3Xf points = 1e18f * uniformPoints(random, 2000);
  const KdTree tree = treeOf(points);
  for (std::uint32_t hint = 0; hint < 100; ++hint) {
    const Eigen::Vector3f query = 1e18f * uniformPoints(random, 1);
    const KdTree::Neighbor found = tree.nearest(query, infinity, hint);
    ASSERT_NE(found.index, KdTree::none);
    ASSERT_TRUE(isSame(found, bruteForce(points, query, infinity)));
  }
  const Eigen::Vector3f far = Eigen::Vector3f::Constant(3e38f);
  EXPECT_TRUE(isNone(tree.nearest(far, infinity)));
  EXPECT_TRUE(isNone(tree.nearest(far, infinity, 0)));
  Eigen::Matrix3Xf extremes = Eigen::Matrix3Xf::Constant(3, 40, 3e38f);
  extremes.leftCols(20) *= -1.f;
  EXPECT_EQ(treeOf(extremes).nearest(far, infinity, 3).index, 20u);
}

TEST_P(KdTreePath, TiesOfRepeatedPointsAreSeenAcrossLeaves)
{
  // Leaves of 16: so many repeated points are alone in theirs, and some are not.
  for (Eigen::Index num_others = 10; num_others < 20; ++num_others) {
    Eigen::Matrix3Xf points = Eigen::Matrix3Xf::Constant(3, num_others + 40, 100.f);
    for (Eigen::Index i = 0; i < num_others; ++i)
      points.col(num_others + 39 - i) << static_cast<float>(i), 0.f, 0.f;
    const KdTree tree = treeOf(points);
    const Eigen::Vector3f query(101.f, 100.f, 100.f);
    for (std::uint32_t hint = 0; hint < points.cols(); ++hint)
      ASSERT_TRUE(isSame(tree.nearest(query, infinity, hint), {0, 1.f, true}));
    EXPECT_FALSE(tree.nearest(Eigen::Vector3f(0.1f, 0.f, 0.f), infinity).is_tied);
  }
}

} // namespace
} // namespace bayesian_icp::test
