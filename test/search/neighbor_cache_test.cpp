// NeighborCache against the tree, to the last bit.
#include "search/kd_tree_test_support.h"
#include "search/neighbor_cache.h"

#include <bayesian_icp/kd_tree.h>

#include <gtest/gtest.h>

#include <limits>

namespace bayesian_icp::test {
namespace {

/** From \p home, straight to where the point \p rival is as near as the nearest one:
 * which of them is found there depends on the last bit. */
Eigen::Vector3f
halfWay(const Eigen::Vector3f& home,
        const Eigen::Vector3f& nearest,
        const Eigen::Vector3f& rival)
{
  const Eigen::Vector3d line = (rival - nearest).cast<double>();
  if (line.isZero(0.0))
    return home;
  const double excess = (rival - home).cast<double>().squaredNorm() -
                        (nearest - home).cast<double>().squaredNorm();
  return (home.cast<double>() + excess / (2.0 * line.squaredNorm()) * line)
      .cast<float>();
}

TEST_P(KdTreePath, ACacheAnswersAsTheTreeWhereverThePointIsMoved)
{
  Random random(21, 0);
  for (const Cloud& cloud : clouds())
    for (const Eigen::Index size : {1, 2, 17, 129, 3000}) {
      const Eigen::Matrix3Xf points = cloud.make(random, size);
      const KdTree tree = treeOf(points);
      for (int turn = 0; turn < 24; ++turn) {
        const float gate = turn % 3 == 0 ? infinity : turn % 3 == 1 ? 0.01f : 1e-4f;
        Eigen::Vector3f home = cloud.make(random, 1) + offset(random, turn);
        NeighborCache cache(1);
        for (int i = 0; i < 600; ++i) {
          constexpr float steps[] = {0.f, 1e-6f, 1e-4f, 3e-3f, 0.03f, 0.3f};
          const float step = steps[random.index(6)];
          Eigen::Vector3f query =
              home + step * (uniformPoints(random, 1).array() - 0.5f).matrix();
          if (i % 4 == 3)
            query = halfWay(
                home,
                points.col(tree.nearest(home, infinity).index),
                points.col(static_cast<Eigen::Index>(random.index(points.cols()))));
          if (i == 400)
            home = query;
          ASSERT_EQ(cache.nearest(tree, gate, 0, query),
                    tree.nearest(query, gate).index)
              << cloud.name << ", " << size << " points, turn " << turn << ", query "
              << i << ": " << query.transpose();
        }
      }
    }
}

TEST_P(KdTreePath, ACacheLeavesTheTreeAloneWhereTheAnswerIsKnown)
{
  Random random(22, 0);
  const Eigen::Matrix3Xf points = uniformPoints(random, 1000);
  const KdTree tree = treeOf(points), empty = treeOf(Eigen::Matrix3Xf(3, 0));
  constexpr float gate = 0.2f * 0.2f;
  for (const Eigen::Vector3f& home :
       {Eigen::Vector3f(0.5f, 0.5f, 0.5f), Eigen::Vector3f(0.5f, 0.5f, 1.1f)}) {
    NeighborCache cache(1);
    const auto nearby = [&](float step) -> Eigen::Vector3f {
      return home + step * (uniformPoints(random, 1).array() - 0.5f).matrix();
    };
    for (int i = 0; i < 100; ++i)
      cache.nearest(tree, gate, 0, nearby(0.01f));
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector3f query = nearby(0.01f);
      const std::uint32_t expected = tree.nearest(query, gate).index;
      ASSERT_NE(expected, KdTree::none);
      ASSERT_EQ(cache.nearest(empty, gate, 0, query), expected);
    }
  }
}

TEST_P(KdTreePath, ACacheKnowsWhereNothingIsWithinTheGate)
{
  // A nearest point at 0.5, and a gate at 0.3.
  const KdTree tree = treeOf(Eigen::Vector3f::Zero()),
               nearer = treeOf(Eigen::Vector3f(0.5f, 0.f, 0.f));
  constexpr float gate = 0.3f * 0.3f;
  NeighborCache cache(1);
  for (int i = 0; i < 40; ++i)
    ASSERT_EQ(cache.nearest(tree, gate, 0, {0.5f, 0.f, 0.f}), KdTree::none);
  // 0.19 nearer it is known still; at the gate it is not.
  EXPECT_EQ(cache.nearest(nearer, gate, 0, {0.31f, 0.f, 0.f}), KdTree::none);
  EXPECT_EQ(cache.nearest(tree, gate, 0, {0.29f, 0.f, 0.f}), 0u);
}

TEST_P(KdTreePath, ACacheHasNoNeighborForPlacesThatAreNotFinite)
{
  Random random(23, 0);
  const Eigen::Matrix3Xf points = uniformPoints(random, 100);
  const KdTree tree = treeOf(points);
  NeighborCache cache(1);
  const Eigen::Vector3f home(0.2f, 0.3f, 0.4f);
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < 200; ++i)
    for (const float x : {nan, infinity, 3e38f, 0.1f}) {
      const Eigen::Vector3f query = home + x * Eigen::Vector3f::UnitX();
      ASSERT_EQ(cache.nearest(tree, infinity, 0, query),
                tree.nearest(query, infinity).index);
    }
}

} // namespace
} // namespace bayesian_icp::test
