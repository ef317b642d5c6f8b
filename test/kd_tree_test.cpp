// KdTree against brute force, and its promises at the edges.
#include "kd_tree_test_support.h"

#include <bayesian_icp/kd_tree.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <thread>
#include <utility>
#include <vector>

namespace bayesian_icp {
namespace test {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

class KdTreePath : public testing::TestWithParam<InstructionSet> {
protected:
  KdTree
  treeOf(const Eigen::Matrix3Xf& points) const
  {
    return KdTree(points, 1, GetParam());
  }
};

std::string
nameOf(const testing::TestParamInfo<InstructionSet>& tested)
{
  constexpr const char* names[] = {"Plain", "Sse2", "Avx2"};
  return names[static_cast<int>(tested.param)];
}

INSTANTIATE_TEST_SUITE_P(InstructionSets,
                         KdTreePath,
                         testing::ValuesIn(supportedInstructionSets()),
                         nameOf);

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
    for (int i = 0; i < 10; ++i) {
      const Eigen::Vector3f query = cloud.make(random, 1) + offset(random, i);
      const KdTree::Neighbor expected = tree.nearest(query, 0.05f);
      for (std::uint32_t hint = 0; hint < 700; ++hint)
        ASSERT_TRUE(isSame(tree.nearest(query, 0.05f, hint), expected)) << cloud.name;
    }
  }
}

TEST_P(KdTreePath, GateIsInclusive)
{
  Random random(3, 0);
  const Eigen::Matrix3Xf points = clouds().front().make(random, 500);
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
  Eigen::Matrix3Xf points = clouds().front().make(random, 300);
  for (Eigen::Index i = 0; i < 300; i += 3)
    points(i % 2, i) = i % 4 == 0 ? nan : i % 4 == 1 ? infinity : -infinity;
  const KdTree tree = treeOf(points);
  EXPECT_EQ(tree.size(), 200u);
  for (std::uint32_t hint = 0; hint < 300; ++hint) {
    const Eigen::Vector3f query = clouds().front().make(random, 1);
    ASSERT_TRUE(isSame(tree.nearest(query, infinity, hint),
                       bruteForce(points, query, infinity)));
  }
  const KdTree nothing = treeOf(Eigen::Matrix3Xf::Constant(3, 40, nan));
  EXPECT_TRUE(isNone(nothing.nearest(Eigen::Vector3f::Zero(), infinity, 3)));
}

TEST_P(KdTreePath, NonFiniteQueryHasNoNeighbor)
{
  Random random(5, 0);
  const KdTree tree = treeOf(clouds().front().make(random, 100));
  for (const float coordinate : {nan, infinity, -infinity})
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3f query = coordinate * Eigen::Vector3f::Unit(axis);
      EXPECT_TRUE(isNone(tree.nearest(query, infinity)));
      EXPECT_TRUE(isNone(tree.nearest(query, infinity, 5)));
    }
}

TEST_P(KdTreePath, HugeCoordinatesAreSearchedAndOverflowIsBeyondEveryGate)
{
  Random random(6, 0);
  const Eigen::Matrix3Xf points = 1e18f * clouds().front().make(random, 2000);
  const KdTree tree = treeOf(points);
  for (std::uint32_t hint = 0; hint < 100; ++hint) {
    const Eigen::Vector3f query = 1e18f * clouds().front().make(random, 1);
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

TEST(KdTree, AllInstructionSetsGiveTheSameBits)
{
  Random random(7, 0);
  const Eigen::Matrix3Xf points = clouds().front().make(random, 20000);
  std::vector<KdTree> trees;
  for (const InstructionSet set : supportedInstructionSets())
    trees.emplace_back(points, 1, set);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3f query = clouds().front().make(random, 1) + offset(random, i);
    const auto hint = static_cast<std::uint32_t>(random.index(20000));
    const KdTree::Neighbor expected = trees.front().nearest(query, infinity);
    for (const KdTree& tree : trees)
      ASSERT_TRUE(isSame(tree.nearest(query, infinity, hint), expected));
  }
}

TEST(KdTree, SeveralThreadsMaySearchAtOnce)
{
  Random random(8, 0);
  const Eigen::Matrix3Xf points = clouds().front().make(random, 5000);
  const Eigen::Matrix3Xf queries = clouds().front().make(random, 5000);
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

TEST(KdTree, AnswersAfterAMove)
{
  Random random(9, 0);
  const Eigen::Matrix3Xf points = clouds().front().make(random, 200);
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
} // namespace test
} // namespace bayesian_icp
