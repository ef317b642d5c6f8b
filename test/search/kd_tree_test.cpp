// KdTree against brute force, and its promises at the edges.
#include "search/kd_tree_test_support.h"

#include <bayesian_icp/kd_tree.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

namespace bayesian_icp::test {
namespace {

INSTANTIATE_TEST_SUITE_P(InstructionSets,
                         KdTreePath,
                         testing::ValuesIn(supportedInstructionSets()),
                         nameOf);

/** To the last bit, so that all instruction sets answer alike. */
TEST_P(KdTreePath, FindsTheSameAsBruteForceWhateverTheCloudTheGateAndTheHint)
{
  Random random(1, 0);
  for (const Cloud& cloud : clouds())
    for (const Eigen::Index size : {1, 2, 15, 16, 17, 128, 129, 1025, 3000}) {
      const Eigen::Matrix3Xf points = cloud.make(random, size);
      const KdTree tree = treeOf(points);
      for (int i = 0; i < 60; ++i) {
        const Eigen::Vector3f query = cloud.make(random, 1) + offset(random, i);
        const float gate = i % 3 == 0 ? infinity : i % 3 == 1 ? 0.01f : 1e-4f;
        const KdTree::Neighbor expected = bruteForce(points, query, gate);
        const auto any = static_cast<std::uint32_t>(random.index(points.cols()));
        const auto beyond = static_cast<std::uint32_t>(size);
        for (const std::uint32_t hint : {KdTree::none, any, expected.index, beyond})
          ASSERT_TRUE(isSame(tree.nearest(query, gate, hint), expected))
              << cloud.name << ", " << size << " points, query " << query.transpose()
              << ", gate " << gate << ", hint " << hint;
      }
    }
}

TEST_P(KdTreePath, AnswersTheSameForEveryHint)
{
  Random random(2, 0);
  for (const Cloud& cloud : clouds()) {
    const Eigen::Matrix3Xf points = cloud.make(random, 700);
    const KdTree tree = treeOf(points);
    for (int i = 0; i < 40; ++i) {
      const Eigen::Vector3f query = cloud.make(random, 1) + offset(random, i);
      const KdTree::Neighbor expected = tree.nearest(query, 0.05f);
      for (std::uint32_t hint = 0; hint < 700; ++hint)
        ASSERT_TRUE(isSame(tree.nearest(query, 0.05f, hint), expected)) << cloud.name;
    }
  }
}

TEST_P(KdTreePath, AnswersTheSameForHintsNearby)
{
  Random random(10, 0);
  for (const Cloud& cloud : clouds()) {
    const KdTree tree = treeOf(cloud.make(random, 10000));
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector3f query = cloud.make(random, 1);
      const KdTree::Neighbor expected = tree.nearest(query, infinity);
      for (const float distance : {0.01f, 0.03f, 0.1f}) {
        const Eigen::Vector3f last_query =
            query.array() + distance * (uniformPoints(random, 1).array() - 0.5f);
        const std::uint32_t hint = tree.nearest(last_query, infinity).index;
        ASSERT_TRUE(isSame(tree.nearest(query, infinity, hint), expected))
            << cloud.name;
      }
    }
  }
}

TEST_P(KdTreePath, OfTwoEquallyNearPointsInDifferentSubtreesTheFirstIsFound)
{
  // A lattice of 16 x 16 x 16, from the last corner to the first.
  Eigen::Matrix3Xf points(3, 4096);
  for (int i = 0; i < 4096; ++i)
    points.col(4095 - i) = Eigen::Vector3i(i % 16, i / 16 % 16, i / 256).cast<float>();
  const KdTree tree = treeOf(points);
  for (std::uint32_t later = 0; later < 4096; ++later)
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3f query =
          points.col(later) + 0.5f * Eigen::Vector3f::Unit(axis);
      const KdTree::Neighbor expected = bruteForce(points, query, infinity);
      ASSERT_TRUE(isSame(tree.nearest(query, infinity), expected));
      ASSERT_TRUE(isSame(tree.nearest(query, infinity, later), expected));
    }
}

TEST(KdTree, SeveralThreadsMaySearchAtOnce)
{
  Random random(8, 0);
  const Eigen::Matrix3Xf points = uniformPoints(random, 5000);
  const Eigen::Matrix3Xf queries = uniformPoints(random, 5000);
  const KdTree tree(points);
  std::vector<KdTree::Neighbor> found(5000), expected(5000);
  const auto search = [&](std::size_t from, std::vector<KdTree::Neighbor>& to) {
    for (std::size_t i = from; i < 5000; i += 2)
      to[i] = tree.nearest(queries.col(static_cast<Eigen::Index>(i)), infinity);
  };
  search(0, expected);
  search(1, expected);
  std::thread even(search, 0, std::ref(found)), odd(search, 1, std::ref(found));
  even.join();
  odd.join();
  for (std::size_t i = 0; i < 5000; ++i)
    ASSERT_TRUE(isSame(found[i], expected[i]));
}

TEST(SearchInBlocks, AsksEachQueryOnceWhateverTheNumberOfThreads)
{
  for (const std::size_t count : {0U, 1U, 1000U, 30001U})
    for (const int num_threads : {0, 1, 3}) {
      std::vector<std::atomic<int>> times(count);
      searchInBlocks(count, num_threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          ++times[i];
      });
      EXPECT_TRUE(
          std::all_of(times.begin(), times.end(), [](const auto& n) { return n == 1; }))
          << count << " queries, " << num_threads << " threads";
    }
}

TEST(SearchInBlocks, PassesOnAnException)
{
  for (const int num_threads : {1, 3})
    EXPECT_THROW(searchInBlocks(30001,
                                num_threads,
                                [](std::size_t begin, std::size_t) {
                                  if (begin > 20000)
                                    throw std::runtime_error("told");
                                }),
                 std::runtime_error);
}

TEST(KdTree, AnswersAfterAMove)
{
  Random random(9, 0);
  const Eigen::Matrix3Xf points = uniformPoints(random, 200);
  KdTree built(points);
  KdTree tree(Eigen::Matrix3Xf::Zero(3, 1));
  tree = std::move(built);
  EXPECT_EQ(tree.points(), points);
  EXPECT_EQ(tree.nearest(points.col(150), 0.f).index, 150u);
}

TEST(KdTree, RefusesAnInstructionSetThatIsNotSupported)
{
  EXPECT_THROW(KdTree(Eigen::Matrix3Xf::Zero(3, 1), 1, static_cast<InstructionSet>(99)),
               std::invalid_argument);
}

TEST(KdTree, NeedsNoMoreMemoryThanStated)
{
  for (const Eigen::Index size : {0, 1, 17, 130, 1025, 8193, 65537, 70000}) {
    const KdTree tree(Eigen::Matrix3Xf::Random(3, size));
    EXPECT_LE(tree.numBytes(), 24u * static_cast<std::size_t>(size) + 1024u);
  }
}

} // namespace
} // namespace bayesian_icp::test
