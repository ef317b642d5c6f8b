#include "search/point_neighbors.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace bayesian_icp {

using Eigen::Vector3f;
using kd_tree::fan_out;
using kd_tree::Leaf;
using kd_tree::leaf_size;
using kd_tree::Node;

namespace {

/** Above any squared distance to a neighbour; below that to a place without a point, or
 * with one so far away that a float cannot hold it. */
constexpr float no_limit = std::numeric_limits<float>::max();

/** A level leaves at most seven of its children behind, and 2^32 points have less than
 * eleven levels. */
constexpr std::size_t max_pending = 11 * fan_out;

std::uint64_t
keyOf(float squared_distance, std::uint32_t index)
{
  std::uint32_t bits;
  std::memcpy(&bits, &squared_distance, sizeof(bits));
  return (std::uint64_t(bits) << 32) | index;
}

float
squaredDistanceOf(std::uint64_t key)
{
  const auto bits = static_cast<std::uint32_t>(key >> 32);
  float squared_distance;
  std::memcpy(&squared_distance, &bits, sizeof(bits));
  return squared_distance;
}

/** Subtrees still to be searched, the nearest one last. */
class Pending {
public:
  struct Subtree {
    float bound;
    std::uint32_t number;
  };

  bool
  isEmpty() const
  {
    return end_ == subtrees_;
  }

  Subtree
  take()
  {
    return *--end_;
  }

  void
  add(Subtree subtree)
  {
    *end_++ = subtree;
  }

  /** The children whose boxes are within \p limit. */
  void
  addChildren(const Node& node,
              std::uint32_t number,
              const Vector3f& query,
              float limit)
  {
    float bounds[fan_out];
    for (std::size_t child = 0; child < fan_out; ++child)
      bounds[child] = squaredNorm(offset(node, 0, child, query[0]),
                                  offset(node, 1, child, query[1]),
                                  offset(node, 2, child, query[2]));
    Subtree* const first = end_;
    for (std::size_t child = 0; child < fan_out; ++child) {
      if (bounds[child] > limit)
        continue;
      Subtree* place = end_++;
      for (; place > first && place[-1].bound < bounds[child]; --place)
        *place = place[-1];
      *place = {bounds[child],
                static_cast<std::uint32_t>(fan_out * number + 1 + child)};
    }
  }

  static float
  squaredNorm(float x, float y, float z)
  {
    return (x * x + y * y) + z * z;
  }

private:
  static float
  offset(const Node& node, std::size_t axis, std::size_t child, float coordinate)
  {
    return std::max(std::max(node.lower[axis][child] - coordinate,
                             coordinate - node.upper[axis][child]),
                    0.f);
  }

  Subtree subtrees_[max_pending];
  Subtree* end_ = subtrees_;
};

/** Append the points of a leaf that are within \p limit; there is room for all. */
std::uint64_t*
appendLeaf(const Leaf& leaf, const Vector3f& query, float limit, std::uint64_t* end)
{
  float squared_distances[leaf_size];
  for (std::size_t i = 0; i < leaf_size; ++i)
    squared_distances[i] = Pending::squaredNorm(leaf.coordinates[0][i] - query[0],
                                                leaf.coordinates[1][i] - query[1],
                                                leaf.coordinates[2][i] - query[2]);
  for (std::size_t i = 0; i < leaf_size; ++i) {
    *end = keyOf(squared_distances[i], leaf.index[i]);
    end += squared_distances[i] <= limit ? 1 : 0;
  }
  return end;
}

/** Sort the \p count nearest of the keys to the front: into buckets of equal width in
 * the squared distance, over which points of a surface are spread evenly, and then
 * those. */
void
sortNearest(const std::vector<std::uint64_t>& keys,
            std::size_t count,
            std::vector<std::uint64_t>& sorted,
            std::vector<std::uint32_t>& buckets)
{
  float furthest = 0.f;
  for (const auto key : keys)
    furthest = std::max(furthest, squaredDistanceOf(key));
  const auto num_buckets = keys.size();
  const float scale =
      furthest > 0.f ? static_cast<float>(num_buckets - 1) / furthest : 0.f;
  const bool is_scaled = std::isfinite(scale);
  const auto bucketOf = [&](std::uint64_t key) {
    return is_scaled
               ? std::min(static_cast<std::size_t>(squaredDistanceOf(key) * scale),
                          num_buckets - 1)
               : std::size_t(0);
  };
  buckets.assign(num_buckets, 0);
  for (const auto key : keys)
    ++buckets[bucketOf(key)];
  std::uint32_t sum = 0;
  for (auto& bucket : buckets) { // where it ends ...
    sum += bucket;
    bucket = sum;
  }
  sorted.resize(keys.size());
  for (const auto key : keys)
    sorted[--buckets[bucketOf(key)]] = key; // ... and, in the end, begins
  const auto begin = sorted.begin();
  for (std::size_t bucket = 0; bucket < num_buckets; ++bucket) {
    const std::size_t first = buckets[bucket];
    if (first >= count)
      break;
    const std::size_t last =
        bucket + 1 < num_buckets ? buckets[bucket + 1] : sorted.size();
    if (last - first > 1)
      std::sort(begin + static_cast<std::ptrdiff_t>(first),
                begin + static_cast<std::ptrdiff_t>(last));
  }
}

} // namespace

PointNeighbors::PointNeighbors(const Eigen::Matrix3Xf& points)
: points_(points)
, tree_(kd_tree::build(points.data(),
                       static_cast<std::size_t>(points.cols()),
                       1,
                       kd_tree::RepeatedPoints::Kept))
{}

std::vector<std::uint32_t>
PointNeighbors::alongTree() const
{
  std::vector<std::uint32_t> indices;
  indices.reserve(tree_.num_points);
  for (const Leaf& leaf : tree_.leaves)
    for (const std::uint32_t index : leaf.index)
      if (index != kd_tree::no_point)
        indices.push_back(index);
  return indices;
}

/** All points within the square root of \p limit, or the nearest ones of them, at least
 * \p count. */
std::size_t
PointNeighbors::gather(const Vector3f& query,
                       std::size_t count,
                       float limit,
                       std::vector<std::uint64_t>& found) const
{
  const std::size_t most = 2 * count + leaf_size;
  found.resize(most + leaf_size);
  std::uint64_t* const first = found.data();
  std::uint64_t* end = first;
  Pending pending;
  pending.add({0.f, 0});
  while (!pending.isEmpty()) {
    const auto subtree = pending.take();
    if (subtree.bound > limit)
      continue;
    if (subtree.number < tree_.first_leaf) {
      pending.addChildren(tree_.nodes[subtree.number], subtree.number, query, limit);
      continue;
    }
    end =
        appendLeaf(tree_.leaves[subtree.number - tree_.first_leaf], query, limit, end);
    if (end > first + most) {
      std::nth_element(first, first + count - 1, end);
      end = first + count;
      limit = squaredDistanceOf(end[-1]);
    }
  }
  found.resize(static_cast<std::size_t>(end - first));
  return found.size();
}

void
PointNeighbors::find(const Vector3f& query, std::size_t count, NeighborList& list) const
{
  count = std::min(count, tree_.num_points);
  auto& balls = list.last_balls_;
  auto ball = std::find_if(
      balls.begin(), balls.end(), [&](const auto& b) { return b.count == count; });
  if (ball == balls.end())
    ball = balls.insert(balls.end(), {count, query, std::sqrt(no_limit)});
  // The points in the last ball are in this one, too; a little more for rounding.
  const float radius = 1.0001f * (ball->radius + (query - ball->query).norm());
  const float limit = std::min(radius * radius, no_limit);
  if (gather(query, count, limit, list.found_) < count)
    count = std::min(count, gather(query, count, no_limit, list.found_));
  sortNearest(list.found_, count, list.sorted_, list.buckets_);
  list.indices.resize(count);
  list.squared_distances.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    list.indices[i] = static_cast<std::uint32_t>(list.sorted_[i]);
    list.squared_distances[i] = squaredDistanceOf(list.sorted_[i]);
  }
  if (count > 0) {
    ball->query = query;
    ball->radius = std::sqrt(list.squared_distances.back());
  }
}

} // namespace bayesian_icp
