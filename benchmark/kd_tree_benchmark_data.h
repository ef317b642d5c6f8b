/** \file
 * \brief What kd_tree_benchmark searches: queries as a sampler of poses makes them.
 */
#pragma once

#include <bayesian_icp/kd_tree.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

/** Points to find neighbours of, and for each the neighbour that it had at a pose
 * nearby: what a sampler knows from its last visit. */
struct Queries {
  Eigen::Matrix3Xf points;
  std::vector<std::uint32_t> last_neighbors;
};

struct Scene {
  Eigen::Matrix3Xf target;
  Queries scan_order;
  Queries random_order;
};

inline Queries
shuffled(const Queries& queries)
{
  std::vector<Eigen::Index> order(queries.last_neighbors.size());
  std::iota(order.begin(), order.end(), Eigen::Index(0));
  std::shuffle(order.begin(), order.end(), std::mt19937(2));
  Queries result{queries.points(Eigen::all, order), {}};
  for (const Eigen::Index i : order)
    result.last_neighbors.push_back(
        queries.last_neighbors[static_cast<std::size_t>(i)]);
  return result;
}

/** Up to 50 000 queries: points of the target, moved by a pose 7 mm and 0.01 rad off.
 * The last visit was at a pose that differs from it by another 2 mm and 0.003 rad. */
inline Scene
makeScene(const Eigen::Matrix3Xf& target)
{
  const Eigen::Index step = std::max<Eigen::Index>(target.cols() / 50000, 1);
  Eigen::Matrix3Xf source(3, target.cols() / step);
  for (Eigen::Index i = 0; i < source.cols(); ++i)
    source.col(i) = target.col(i * step);
  const auto pose = [](float distance, float angle) {
    const Eigen::Vector3f axis = Eigen::Vector3f(1.f, -2.f, 3.f).normalized();
    return Eigen::Translation3f(0.f, 0.6f * distance, 0.8f * distance) *
           Eigen::AngleAxisf(angle, axis);
  };
  Queries queries{pose(0.007f, 0.01f) * source, {}};
  const Eigen::Matrix3Xf last_visit = pose(0.009f, 0.013f) * source;
  const bayesian_icp::KdTree tree(target);
  for (Eigen::Index i = 0; i < last_visit.cols(); ++i)
    queries.last_neighbors.push_back(
        tree.nearest(last_visit.col(i), std::numeric_limits<float>::infinity()).index);
  return {target, queries, shuffled(queries)};
}
