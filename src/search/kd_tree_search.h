/** \file
 * \brief Internal: the searches in a tree of boxes, written once for all instruction
 * sets, and for the nearest point (Best), the k nearest ones (NearestK) and those that
 * are the nearest to a query close by (Rivals).
 *
 * Included by the kernels only. A kernel says what its vectors can do: a Pack is
 * `width` floats, which the compiler's operators add, subtract, multiply and divide,
 * with load(), fill(), min(), max(), lessEqual() and equal() (a bit for each float),
 * smallest() and store(). Everything here is in an unnamed namespace, so that no
 * kernel's code is ever taken for another's.
 *
 * The kernels agree to the last bit: the same operations in the same order, none fused.
 * A rounded difference, square and sum are monotonous, so that the bound of a box,
 * taken like the distance of a point, is never above the distance of a point in it: the
 * searches are exact in single precision, ties included.
 */
#pragma once

#include "search/kd_tree_kernels.h"

#include <cstddef>
#include <cstdint>

namespace bayesian_icp::kd_tree {
namespace {

/** A subtree still to be searched, and the bound of its box. */
struct Pending {
  float bound;
  std::uint32_t number;
};

/** A level leaves at most seven of its children behind, and 2^32 points have less than
 * eleven levels. */
constexpr std::size_t max_pending = 11 * (fan_out - 1);

inline bool
isBetter(float squared_distance, std::uint32_t index, const Best& best)
{
  return squared_distance < best.squared_distance ||
         (squared_distance == best.squared_distance && index < best.index);
}

/** Whether all that is as near as \p best is strictly inside the cell. */
inline bool
isDecidedIn(const Cell& cell, const float* query, const Best& best)
{
  float margin = query[0] - cell.lower[0];
  for (int axis = 0; axis < 3; ++axis) {
    const float below = query[axis] - cell.lower[axis];
    const float above = cell.upper[axis] - query[axis];
    margin = below < margin ? below : margin;
    margin = above < margin ? above : margin;
  }
  return margin > 0.f && margin * margin > best.squared_distance;
}

/** The lowest node above a leaf that has all points as near as \p best; or the leaf
 * itself, if it is the root. */
inline std::uint32_t
climb(const View& tree, std::uint32_t leaf, const float* query, const Best& best)
{
  std::uint32_t number = tree.first_leaf + leaf;
  while (number > 0) {
    number = (number - 1) / fan_out;
    if (number == 0 || isDecidedIn(tree.cells[number], query, best))
      break;
  }
  return number;
}

template <typename Pack>
inline typename Pack::Vector
squaredNorm(typename Pack::Vector x, typename Pack::Vector y, typename Pack::Vector z)
{
  return x * x + y * y + z * z;
}

inline float
limitOf(const Best& best)
{
  return best.squared_distance;
}

inline float
limitOf(const NearestK& found)
{
  return found.limit;
}

template <typename Pack>
inline typename Pack::Vector
pointOffset(const Leaf& leaf, std::size_t axis, std::size_t place, const float* query)
{
  return Pack::load(leaf.coordinates[axis] + place) - Pack::fill(query[axis]);
}

/** Squared distances of the points of a leaf from \p place on. */
template <typename Pack>
inline typename Pack::Vector
pointDistances(const Leaf& leaf, std::size_t place, const float* query)
{
  return squaredNorm<Pack>(pointOffset<Pack>(leaf, 0, place, query),
                           pointOffset<Pack>(leaf, 1, place, query),
                           pointOffset<Pack>(leaf, 2, place, query));
}

/** The square of a reach: of the distance from the query to the plane half way between
 * two points, of which \p squared_distance is one's distance from the other. */
template <typename Pack>
inline typename Pack::Vector
squaredReach(typename Pack::Vector squared_query_distance,
             typename Pack::Vector squared_distance,
             const Rivals& found)
{
  const auto excess =
      Pack::max(squared_query_distance - Pack::fill(found.threshold), Pack::fill(0.f));
  return excess * excess / (Pack::fill(4.f) * squared_distance);
}

/** What points are ranked by: their squared distances, ... */
template <typename Pack>
inline typename Pack::Vector
pointRanks(const Leaf& leaf, std::size_t place, const float* query, const NearestK&)
{
  return pointDistances<Pack>(leaf, place, query);
}

/** ... or their squared reaches. */
template <typename Pack>
inline typename Pack::Vector
pointRanks(const Leaf& leaf, std::size_t place, const float* query, const Rivals& found)
{
  return squaredReach<Pack>(pointDistances<Pack>(leaf, place, query),
                            pointDistances<Pack>(leaf, place, found.nearest),
                            found);
}

/** Distance to an interval along one axis, 0 inside. */
template <typename Pack>
inline typename Pack::Vector
boxOffset(const Node& node, std::size_t axis, std::size_t child, const float* query)
{
  const auto coordinate = Pack::fill(query[axis]);
  const auto below = Pack::load(node.lower[axis] + child) - coordinate;
  const auto above = coordinate - Pack::load(node.upper[axis] + child);
  return Pack::max(Pack::max(below, above), Pack::fill(0.f));
}

template <typename Pack>
inline void
searchLeaf(const Leaf& leaf, const float* query, Best& best)
{
  constexpr std::size_t num_packs = leaf_size / Pack::width;
  typename Pack::Vector distances[num_packs];
  for (std::size_t i = 0; i < num_packs; ++i)
    distances[i] = pointDistances<Pack>(leaf, i * Pack::width, query);
  auto nearest = distances[0];
  for (std::size_t i = 1; i < num_packs; ++i)
    nearest = Pack::min(nearest, distances[i]);
  if (!Pack::lessEqual(nearest, Pack::fill(best.squared_distance)))
    return;
  const float smallest = Pack::smallest(nearest);
  unsigned equal = 0;
  for (std::size_t i = 0; i < num_packs; ++i)
    equal |= Pack::equal(distances[i], Pack::fill(smallest)) << (i * Pack::width);
  const std::uint32_t index = leaf.index[__builtin_ctz(equal)];
  const bool has_found_one = best.index != no_point;
  const bool is_tied = (equal & (equal - 1)) != 0 ||
                       (has_found_one && smallest == best.squared_distance);
  if (isBetter(smallest, index, best))
    best = {smallest, index, is_tied};
  else
    best.is_tied = is_tied;
}

template <typename Pack, typename Found>
inline void
searchLeaf(const Leaf& leaf, const float* query, Found& found)
{
  alignas(64) float distances[leaf_size];
  unsigned wanted = 0;
  for (std::size_t place = 0; place < leaf_size; place += Pack::width) {
    const auto some = pointRanks<Pack>(leaf, place, query, found);
    wanted |= Pack::lessEqual(some, Pack::fill(found.limit)) << place;
    Pack::store(distances + place, some);
  }
  for (; wanted != 0; wanted &= wanted - 1) {
    const int i = __builtin_ctz(wanted);
    std::uint32_t bits;
    __builtin_memcpy(&bits, distances + i, sizeof(bits));
    *found.end++ = std::uint64_t(bits) << 32 | leaf.index[i];
  }
  if (found.end > found.first + 2 * found.count + leaf_size)
    dropOthers(found);
}

/** Squared distances of boxes. */
template <typename Pack>
inline typename Pack::Vector
boxDistances(const Node& node, std::size_t child, const float* query)
{
  return squaredNorm<Pack>(boxOffset<Pack>(node, 0, child, query),
                           boxOffset<Pack>(node, 1, child, query),
                           boxOffset<Pack>(node, 2, child, query));
}

/** Distance to the far end of an interval along one axis. */
template <typename Pack>
inline typename Pack::Vector
farOffset(const Node& node, std::size_t axis, std::size_t child, const float* query)
{
  const auto coordinate = Pack::fill(query[axis]);
  return Pack::max(coordinate - Pack::load(node.lower[axis] + child),
                   Pack::load(node.upper[axis] + child) - coordinate);
}

/** Not above the ranks of the points in boxes. */
template <typename Pack, typename Found>
inline typename Pack::Vector
boxRanks(const Node& node, std::size_t child, const float* query, const Found&)
{
  return boxDistances<Pack>(node, child, query);
}

template <typename Pack>
inline typename Pack::Vector
boxRanks(const Node& node, std::size_t child, const float* query, const Rivals& found)
{
  return squaredReach<Pack>(
      boxDistances<Pack>(node, child, query),
      squaredNorm<Pack>(farOffset<Pack>(node, 0, child, found.nearest),
                        farOffset<Pack>(node, 1, child, found.nearest),
                        farOffset<Pack>(node, 2, child, found.nearest)),
      found);
}

/** Bounds of the ranks of the children's points; a bit for each child whose bound is
 * within the limit. */
template <typename Pack, typename Found>
inline unsigned
boundChildren(const Node& node, const float* query, const Found& found, float* bounds)
{
  unsigned promising = 0;
  for (std::size_t child = 0; child < fan_out; child += Pack::width) {
    const auto bound = boxRanks<Pack>(node, child, query, found);
    promising |= Pack::lessEqual(bound, Pack::fill(limitOf(found))) << child;
    Pack::store(bounds + child, bound);
  }
  return promising;
}

/** Choose the nearest of the promising children, leave the others for later. */
inline Pending
descend(std::uint32_t number, const float* bounds, unsigned promising, Pending*& end)
{
  const std::uint32_t first_child = static_cast<std::uint32_t>(fan_out) * number + 1;
  auto child = static_cast<unsigned>(__builtin_ctz(promising));
  Pending nearest{bounds[child], first_child + child};
  while (promising &= promising - 1) {
    child = static_cast<unsigned>(__builtin_ctz(promising));
    const Pending other{bounds[child], first_child + child};
    const bool is_nearer = other.bound < nearest.bound;
    *end++ = is_nearer ? nearest : other;
    nearest = is_nearer ? other : nearest;
  }
  return nearest;
}

/** Search a subtree completely, but for the leaf that has been searched. */
template <typename Pack, typename Found>
inline void
searchBelow(const View& tree,
            Pending current,
            std::uint32_t searched_leaf,
            const float* query,
            Found& found)
{
  Pending pending[max_pending];
  Pending* end = pending;
  for (;;) {
    unsigned promising = 0;
    if (current.number < tree.first_leaf) {
      alignas(64) float bounds[fan_out];
      promising = boundChildren<Pack>(tree.nodes[current.number], query, found, bounds);
      if (promising)
        current = descend(current.number, bounds, promising, end);
    }
    else if (current.number - tree.first_leaf != searched_leaf) {
      searchLeaf<Pack>(tree.leaves[current.number - tree.first_leaf], query, found);
    }
    if (promising)
      continue;
    do {
      if (end == pending)
        return;
      current = *--end;
    }
    while (current.bound > limitOf(found));
  }
}

template <typename Pack>
void
nearest(const View& tree, const float* query, std::uint32_t hint, Best& best)
{
  const std::uint32_t leaf = hint < tree.num_indices ? tree.leaf_of[hint] : no_leaf;
  Pending top{0.f, 0};
  if (leaf != no_leaf) {
    searchLeaf<Pack>(tree.leaves[leaf], query, best);
    top.number = climb(tree, leaf, query, best);
  }
  searchBelow<Pack>(tree, top, leaf, query, best);
}

template <typename Pack, typename Found>
void
searchAll(const View& tree, const float* query, Found& found)
{
  searchBelow<Pack>(tree, {0.f, 0}, no_leaf, query, found);
}

template <typename Pack>
void
nearestInLeaf(const Leaf& leaf, const float* query, Best& best)
{
  searchLeaf<Pack>(leaf, query, best);
}

/** The searches of one instruction set. */
template <typename Pack>
constexpr Searches
searchesWith()
{
  return {nearest<Pack>,
          searchAll<Pack, NearestK>,
          searchAll<Pack, Rivals>,
          nearestInLeaf<Pack>};
}

} // namespace
} // namespace bayesian_icp::kd_tree
