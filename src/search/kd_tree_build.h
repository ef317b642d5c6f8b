/** \file
 * \brief Internal: the tree of KdTree and PointNeighbors, and how it is built and
 * searched.
 */
#pragma once

#include "search/kd_tree_kernels.h"

#include <bayesian_icp/kd_tree.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace bayesian_icp::kd_tree {

/** What View points to. */
struct Storage {
  std::vector<Node> nodes;
  std::vector<Cell> cells;
  std::vector<Leaf> leaves;
  std::vector<std::uint32_t> leaf_of;
  std::uint32_t first_leaf = 0;
  /** Points in the tree. */
  std::size_t num_points = 0;

  View
  view() const
  {
    return {nodes.data(),
            cells.data(),
            leaves.data(),
            first_leaf,
            leaf_of.data(),
            leaf_of.size()};
  }
};

/** Of a point in NearestK or Rivals, by its key [m^2]. */
inline float
squaredDistanceOf(std::uint64_t key)
{
  const auto bits = static_cast<std::uint32_t>(key >> 32);
  float squared_distance;
  std::memcpy(&squared_distance, &bits, sizeof(bits));
  return squared_distance;
}

/** Whether a search finds all points that are equal to each other, or only the one with
 * the smallest index and the fact that there are more. */
enum class RepeatedPoints { Kept, LeftOut };

/** Build the tree over the finite points among \p num_points points x, y, z, x, y, z,
 * ... The result does not depend on \p num_threads, 0: as OpenMP would. */
Storage
build(const float* points,
      std::size_t num_points,
      int num_threads,
      RepeatedPoints repeated = RepeatedPoints::LeftOut);

/** \throws std::invalid_argument if the instruction set is not supported */
const Searches&
searchesOf(InstructionSet instruction_set);

} // namespace bayesian_icp::kd_tree

/** \brief What a KdTree owns besides its points. */
struct bayesian_icp::KdTree::Tree {
  kd_tree::Storage storage;
  kd_tree::View view;
  kd_tree::Searches searches;
};
