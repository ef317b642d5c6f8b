/** \file
 * \brief Internal: the tree of KdTree in memory and the searches in it, one for each
 * instruction set.
 *
 * The searches are compiled with more instructions than the rest of the library. So
 * this file must not include anything that defines functions: a copy made of, say,
 * std::vector's in such a file could end up in any program that uses it.
 */
#pragma once

#include <cstddef>
#include <cstdint>

namespace bayesian_icp::kd_tree {

constexpr std::size_t fan_out = 8;
constexpr std::size_t leaf_size = 16;

constexpr std::uint32_t no_leaf = 0xffffffff;
/** Greater than the index of any point. */
constexpr std::uint32_t no_point = 0xffffffff;

/** The bounding boxes of a node's children; boxes of no child are at infinity. */
struct alignas(64) Node {
  float lower[3][fan_out];
  float upper[3][fan_out];
};

/** Points by ascending index; the places of a leaf that is not full are at infinity. */
struct alignas(64) Leaf {
  float coordinates[3][leaf_size];
  std::uint32_t index[leaf_size];
};

/** The part of space that belongs to a node: every point with all coordinates strictly
 * inside is in the node. */
struct Cell {
  float lower[3];
  float upper[3];
};

/** What a search sees. Nodes and leaves are numbered together as in a heap: the root is
 * 0, the children of k are 8 * k + 1 to 8 * k + 8, numbers from first_leaf on are
 * leaves. */
struct View {
  const Node* nodes;
  /** Of the nodes. */
  const Cell* cells;
  const Leaf* leaves;
  std::uint32_t first_leaf;
  /** For each index the leaf that its point is in, counted from 0, or no_leaf. */
  const std::uint32_t* leaf_of;
  std::size_t num_indices;
};

/** The best point so far. Before any has been found: the largest squared distance
 * allowed, and no_point. */
struct Best {
  float squared_distance;
  std::uint32_t index;
  /** Whether another point is as near. */
  bool is_tied;
};

/** The nearest points so far, at least as many as are wanted if there are so many. */
struct NearestK {
  /** How many are wanted, at least 1. */
  std::size_t count;
  /** Squared distance beyond which no point is wanted. */
  float limit;
  /** A key for each point: the bits of its squared distance, then its index. Keys sort
   * as the points do: nearest first, equally near ones by their index. There is room
   * for 2 * (count + leaf_size) keys. */
  std::uint64_t* first;
  std::uint64_t* end;
};

/** The points that may be the nearest one when a query has moved a little, ranked by
 * their reach: no nearer than that is a place where the point is as near as the one
 * that is the nearest to the query. Squared reaches take the place of squared distances
 * in the keys. The nearest point itself, and points equal to it, are none of them. */
struct Rivals : NearestK {
  float nearest[3];
  /** The squared distance of the nearest point, and a little more for the rounding of
   * distances. */
  float threshold;
};

/** Keep the \p found.count nearest points, and lower the limit to the last of them. */
void
dropOthers(NearestK& found);

/** The searches for a finite \p query [m], of one instruction set. */
struct Searches {
  /** Improve \p best to the nearest point, among equally near ones that of the smallest
   * index. The search begins around the point with index \p hint, if there is one. */
  void (*nearest)(const View& tree, const float* query, std::uint32_t hint, Best& best);
  /** Add the points to \p found, which has none before. */
  void (*nearestK)(const View& tree, const float* query, NearestK& found);
  void (*rivals)(const View& tree, const float* query, Rivals& found);
  /** Improve \p best as above to the nearest point of one leaf. */
  void (*nearestInLeaf)(const Leaf& leaf, const float* query, Best& best);
};

extern const Searches plain_searches;
#if defined(BAYESIAN_ICP_X86_KERNELS)
extern const Searches sse2_searches;
extern const Searches avx2_searches;
#endif

} // namespace bayesian_icp::kd_tree
