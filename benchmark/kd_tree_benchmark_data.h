/** \file
 * \brief What kd_tree_benchmark searches: a simulated scan, and queries as a sampler of
 * poses makes them.
 */
#pragma once

#include <bayesian_icp/kd_tree.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
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

/** Distance along a ray to the scene: three balls on a table, a wall behind [m]. */
inline float
castRay(const Eigen::Vector3f& eye, const Eigen::Vector3f& direction)
{
  float depth = (1.2f - eye.y()) / direction.y();
  if (direction.z() < 0.f)
    depth = std::min(depth, -eye.z() / direction.z());
  const float radii[] = {0.05f, 0.1f, 0.15f};
  const float positions[] = {-0.25f, 0.f, 0.3f};
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3f offset =
        Eigen::Vector3f(positions[i], 0.1f * static_cast<float>(i), radii[i]) - eye;
    const float along = offset.dot(direction);
    const float inside = radii[i] * radii[i] - (offset.squaredNorm() - along * along);
    if (inside > 0.f)
      depth = std::min(depth, along - std::sqrt(inside));
  }
  return depth;
}

/** A depth camera 1 m from the table, with noise of 1 mm, row by row [m]. */
inline Eigen::Matrix3Xf
scanOfTable(int width, int height)
{
  std::mt19937 generator(1);
  std::normal_distribution<float> noise(0.f, 0.001f);
  const Eigen::Vector3f eye(0.f, -0.7f, 0.7f);
  const Eigen::Matrix3f camera =
      Eigen::AngleAxisf(-0.785f, Eigen::Vector3f::UnitX()).toRotationMatrix();
  Eigen::Matrix3Xf points(3, width * height);
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const float u = (static_cast<float>(column) + 0.5f) / static_cast<float>(width);
      const float v = (static_cast<float>(row) + 0.5f) / static_cast<float>(height);
      const Eigen::Vector3f direction =
          (camera * Eigen::Vector3f(u - 0.5f, 1.f, 0.75f * (0.5f - v))).normalized();
      points.col(row * width + column) =
          eye + (castRay(eye, direction) + noise(generator)) * direction;
    }
  return points;
}

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
