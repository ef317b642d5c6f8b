/** \file
 * \brief Internal: the order of the points in the tree of KdTree.
 *
 * Every leaf is a run of 16 points and every subtree a run of 16 * 8^height points;
 * what is left over makes the last leaf, and the last subtree of every height, smaller.
 * So the shape of the tree follows from the number of points alone, and nodes need no
 * pointers.
 */
#pragma once

#include "search/kd_tree_kernels.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace bayesian_icp {
namespace kd_tree {

constexpr float infinity = std::numeric_limits<float>::infinity();

struct alignas(16) Record {
  float coordinates[3];
  std::uint32_t index;
};

struct Box {
  float lower[3] = {infinity, infinity, infinity};
  float upper[3] = {-infinity, -infinity, -infinity};

  void
  include(const float* lower_corner, const float* upper_corner)
  {
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], lower_corner[axis]);
      upper[axis] = std::max(upper[axis], upper_corner[axis]);
    }
  }
};

/** The nodes, or the leaves, of the same depth. */
struct Level {
  /** Number of the first one. */
  std::size_t begin;
  /** How many there are; they are the first ones of the complete level. */
  std::size_t size;
  /** Points below each of them, unless it is the last one. */
  std::size_t subtree_size;
};

/** The levels from the root to the leaves of a tree of \p num_points points. */
std::vector<Level>
levelsOf(std::size_t num_points);

/** Put the points in the order of the tree. The result does not depend on
 * \p num_threads.
 * \param[out] cells of the nodes, by their numbers */
void
arrange(std::vector<Record>& records,
        const std::vector<Level>& levels,
        Cell* cells,
        int num_threads);

} // namespace kd_tree
} // namespace bayesian_icp
