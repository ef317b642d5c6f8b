// Shared by the tests of KdTree: clouds of every shape, and the search that cannot be
// wrong.
#pragma once

#include <bayesian_icp/kd_tree.h>
#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

namespace bayesian_icp::test {

constexpr float infinity = std::numeric_limits<float>::infinity();

/** A test to be run for every instruction set; kd_tree_test.cpp says which. */
class KdTreePath : public testing::TestWithParam<InstructionSet> {
protected:
  KdTree
  treeOf(const Eigen::Matrix3Xf& points) const
  {
    return KdTree(points, 1, GetParam());
  }
};

inline std::string
nameOf(const testing::TestParamInfo<InstructionSet>& tested)
{
  constexpr const char* names[] = {"Plain", "Sse2", "Avx2"};
  return names[static_cast<int>(tested.param)];
}

struct Cloud {
  std::string name;
  Eigen::Matrix3Xf (*make)(Random& random, Eigen::Index num_points);
};

/** Uniform in the unit cube. */
inline Eigen::Matrix3Xf
uniformPoints(Random& random, Eigen::Index num_points)
{
  Eigen::Matrix3Xf points(3, num_points);
  for (float& coordinate : points.reshaped())
    coordinate = static_cast<float>(random.uniform());
  return points;
}

/** 1 mm wide heaps at the corners of a lattice. */
inline Eigen::Matrix3Xf
clusteredPoints(Random& random, Eigen::Index num_points)
{
  const Eigen::Matrix3Xf corners = uniformPoints(random, num_points);
  return (4.f * corners).array().round() / 4.f +
         1e-3f * uniformPoints(random, num_points).array();
}

inline Eigen::Matrix3Xf
planarPoints(Random& random, Eigen::Index num_points)
{
  Eigen::Matrix3Xf points = uniformPoints(random, num_points);
  points.row(2).setConstant(0.25f);
  return points;
}

inline Eigen::Matrix3Xf
collinearPoints(Random& random, Eigen::Index num_points)
{
  return Eigen::Vector3f(1.f, -2.f, 0.5f) *
         uniformPoints(random, num_points).row(0).eval();
}

/** Few places, many points on each, many equal distances. */
inline Eigen::Matrix3Xf
latticePoints(Random& random, Eigen::Index num_points)
{
  return (3.f * uniformPoints(random, num_points)).array().round();
}

inline Eigen::Matrix3Xf
equalPoints(Random&, Eigen::Index num_points)
{
  return Eigen::Vector3f(0.1f, 0.2f, 0.3f).replicate(1, num_points);
}

inline std::vector<Cloud>
clouds()
{
  return {{"uniform", uniformPoints},
          {"clustered", clusteredPoints},
          {"planar", planarPoints},
          {"collinear", collinearPoints},
          {"lattice", latticePoints},
          {"equal", equalPoints}};
}

/** In turn nothing, a centimetre, some metres, and half a lattice constant: as far from
 * one place of a lattice as from the next. */
inline Eigen::Vector3f
offset(Random& random, int turn)
{
  if (turn % 4 == 3)
    return 0.5f * Eigen::Vector3f::Unit(static_cast<Eigen::Index>(random.index(3)));
  constexpr float sizes[] = {0.f, 0.01f, 3.f};
  return sizes[turn % 4] * (uniformPoints(random, 1).array() - 0.5f).matrix();
}

inline KdTree::Neighbor
bruteForce(const Eigen::Matrix3Xf& points,
           const Eigen::Vector3f& query,
           float max_squared_distance)
{
  KdTree::Neighbor nearest{KdTree::none, infinity, false};
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const float x = points(0, i) - query.x();
    const float y = points(1, i) - query.y();
    const float z = points(2, i) - query.z();
    const float squared_distance = (x * x + y * y) + z * z;
    if (squared_distance > max_squared_distance)
      continue;
    if (squared_distance < nearest.squared_distance)
      nearest = {static_cast<std::uint32_t>(i), squared_distance, false};
    else if (squared_distance == nearest.squared_distance)
      nearest.is_tied = true;
  }
  return nearest;
}

/** To the last bit. */
inline bool
isSame(const KdTree::Neighbor& a, const KdTree::Neighbor& b)
{
  return a.index == b.index && a.squared_distance == b.squared_distance &&
         a.is_tied == b.is_tied;
}

inline bool
isNone(const KdTree::Neighbor& neighbor)
{
  return isSame(neighbor, {KdTree::none, infinity, false});
}

} // namespace bayesian_icp::test
