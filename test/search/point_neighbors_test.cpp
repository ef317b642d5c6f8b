// The k nearest points, which the library does not export, against sorting all of them.
#include "search/kd_tree_test_support.h"
#include "search/point_neighbors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace bayesian_icp::test {
namespace {

using Ranking = std::vector<std::pair<float, std::uint32_t>>;

/** All points by squared distance, then index. */
Ranking
ranking(const Eigen::Matrix3Xf& points, const Eigen::Vector3f& query)
{
  Ranking ranked;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3f d = points.col(i) - query;
    ranked.emplace_back((d.x() * d.x() + d.y() * d.y()) + d.z() * d.z(),
                        static_cast<std::uint32_t>(i));
  }
  std::sort(ranked.begin(), ranked.end());
  return ranked;
}

void
expectNearest(const PointNeighbors& neighbors,
              const Eigen::Vector3f& query,
              std::size_t count,
              NeighborList& list)
{
  neighbors.find(query, count, list);
  const Ranking expected = ranking(neighbors.points(), query);
  count = std::min(count, expected.size());
  ASSERT_EQ(list.indices.size(), count);
  ASSERT_EQ(list.squared_distances.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    ASSERT_EQ(list.squared_distances[i], expected[i].first);
    ASSERT_EQ(list.indices[i], expected[i].second);
  }
}

TEST(PointNeighbors, AreThoseOfSortingAllPointsWhateverWasAskedBefore)
{
  Random random(21, 0);
  for (const Cloud& cloud : clouds()) // lattices and repeated points among them
    for (const Eigen::Index size : {1, 2, 16, 17, 130, 1500}) {
      const Eigen::Matrix3Xf points = cloud.make(random, size);
      const PointNeighbors neighbors(points);
      NeighborList list;
      for (int i = 0; i < 12; ++i) {
        SCOPED_TRACE(cloud.name + ", " + std::to_string(size) + " points");
        const Eigen::Vector3f query = cloud.make(random, 1) + offset(random, i);
        for (const std::size_t count : {45, 1, 90, 720})
          expectNearest(neighbors, query, count, list);
      }
    }
}

TEST(PointNeighbors, AlongTheTreeEveryPointIsVisitedOnce)
{
  Random random(22, 0);
  for (const Cloud& cloud : clouds()) {
    const Eigen::Matrix3Xf points = cloud.make(random, 1000);
    std::vector<std::uint32_t> visited = PointNeighbors(points).alongTree();
    std::sort(visited.begin(), visited.end());
    ASSERT_EQ(visited.size(), 1000u);
    for (std::uint32_t i = 0; i < 1000; ++i)
      ASSERT_EQ(visited[i], i);
  }
}

TEST(PointNeighbors, AreNotPointsTooFarAwayForAFloat)
{
  Eigen::Matrix3Xf points = Eigen::Matrix3Xf::Random(3, 40);
  points.col(7).setConstant(1e30f);
  points.col(23).setConstant(-1e30f);
  const PointNeighbors neighbors(points);
  NeighborList list;
  for (int i = 0; i < 3; ++i) {
    neighbors.find(points.col(0), 40, list);
    ASSERT_EQ(list.indices.size(), 38u);
    EXPECT_EQ(list.squared_distances.size(), 38u);
    EXPECT_LT(list.squared_distances.back(), 12.f);
    neighbors.find(points.col(7), 40, list);
    ASSERT_EQ(list.indices, std::vector<std::uint32_t>{7});
  }
}

} // namespace
} // namespace bayesian_icp::test
