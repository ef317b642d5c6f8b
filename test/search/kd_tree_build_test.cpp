// The tree inside KdTree, which the library does not export: built from its sources.
#include "search/kd_tree_build.h"
#include "search/kd_tree_test_support.h"
#include "threads/for_each_piece.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <vector>

namespace bayesian_icp::test {
namespace {

using kd_tree::Storage;

Storage
buildTree(const Eigen::Matrix3Xf& points, int num_threads)
{
  return kd_tree::build(
      points.data(), static_cast<std::size_t>(points.cols()), num_threads);
}

template <typename T>
bool
isSameMemory(const std::vector<T>& a, const std::vector<T>& b)
{
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

// Of as many points as three threads are used for.
TEST(KdTreeBuild, TreeIsTheSameForAnyNumberOfThreads)
{
  Random random(1, 0);
  for (const Cloud& cloud : clouds()) {
    const Eigen::Matrix3Xf points = cloud.make(random, 150000);
    const Storage expected = buildTree(points, 1);
    for (const int num_threads : {2, 3}) {
      const Storage tree = buildTree(points, num_threads);
      EXPECT_EQ(tree.first_leaf, expected.first_leaf);
      EXPECT_TRUE(isSameMemory(tree.nodes, expected.nodes)) << cloud.name;
      EXPECT_TRUE(isSameMemory(tree.cells, expected.cells)) << cloud.name;
      EXPECT_TRUE(isSameMemory(tree.leaves, expected.leaves)) << cloud.name;
      EXPECT_TRUE(isSameMemory(tree.leaf_of, expected.leaf_of)) << cloud.name;
    }
  }
}

TEST(NumberOfThreads, IsAtMost1024AndNoMoreThanThePieces)
{
  EXPECT_EQ(numThreadsFor(1024, 5000), 1024);
  EXPECT_EQ(numThreadsFor(std::numeric_limits<int>::max(), 5000), 1024);
  EXPECT_EQ(numThreadsFor(5000, 7), 7);
  EXPECT_EQ(numThreadsFor(3, 0), 1);
}

TEST(KdTreeBuild, EveryPointIsInItsLeafAndInTheBoxesAndCellsAboveIt)
{
  Random random(2, 0);
  const Eigen::Matrix3Xf points = uniformPoints(random, 9000);
  const Storage tree = buildTree(points, 2);
  for (std::uint32_t i = 0; i < 9000; ++i) {
    const kd_tree::Leaf& leaf = tree.leaves[tree.leaf_of[i]];
    EXPECT_EQ(std::count(leaf.index, leaf.index + kd_tree::leaf_size, i), 1);
    const Eigen::Vector3f point = points.col(i);
    for (std::uint32_t number = tree.first_leaf + tree.leaf_of[i]; number > 0;) {
      const std::uint32_t child = (number - 1) % kd_tree::fan_out;
      number = (number - 1) / kd_tree::fan_out;
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(tree.nodes[number].lower[axis][child], point[axis]);
        EXPECT_GE(tree.nodes[number].upper[axis][child], point[axis]);
        EXPECT_LE(tree.cells[number].lower[axis], point[axis]);
        EXPECT_GE(tree.cells[number].upper[axis], point[axis]);
      }
    }
  }
}

/** How many leaves a search would look at that has no bound at all. */
std::size_t
countLeaves(const Storage& tree, std::uint32_t number)
{
  if (number >= tree.first_leaf)
    return 1;
  std::size_t count = 0;
  for (std::uint32_t child = 0; child < kd_tree::fan_out; ++child)
    if (tree.nodes[number].lower[0][child] < std::numeric_limits<float>::infinity())
      count += countLeaves(
          tree, static_cast<std::uint32_t>(kd_tree::fan_out * number + 1 + child));
  return count;
}

TEST(KdTreeBuild, EqualPointsTakeOneLeafOfTheSearch)
{
  Random random(3, 0);
  Eigen::Matrix3Xf points = uniformPoints(random, 20000);
  EXPECT_EQ(countLeaves(buildTree(points, 1), 0), 1250u);
  points.rightCols(19000) = equalPoints(random, 19000);
  EXPECT_LT(countLeaves(buildTree(points, 1), 0), 100u);
  EXPECT_EQ(countLeaves(buildTree(equalPoints(random, 20000), 1), 0), 1u);
}

} // namespace
} // namespace bayesian_icp::test
