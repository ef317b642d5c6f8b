#include "search/kd_tree_build.h"

#include "search/kd_tree_arrange.h"
#include "threads/num_threads.h"

#include <cmath>

namespace bayesian_icp {
namespace kd_tree {
namespace {

/** Work of some 5 ms. For less, waking a thread may cost more than it saves, far more
 * if other programs keep the cores busy. */
constexpr std::ptrdiff_t min_points_per_thread = 50000;

std::vector<Record>
finitePoints(const float* points, std::size_t num_points)
{
  std::vector<Record> records;
  records.reserve(num_points);
  for (std::size_t i = 0; i < num_points; ++i) {
    const float* p = points + 3 * i;
    if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]))
      records.push_back({{p[0], p[1], p[2]}, static_cast<std::uint32_t>(i)});
  }
  return records;
}

Leaf
makeLeaf(const Record* first, const Record* last)
{
  Leaf leaf{};
  for (std::size_t i = 0; i < leaf_size; ++i) {
    const bool is_used = first < last;
    for (int axis = 0; axis < 3; ++axis)
      leaf.coordinates[axis][i] = is_used ? first->coordinates[axis] : infinity;
    leaf.index[i] = is_used ? first->index : std::numeric_limits<std::uint32_t>::max();
    first += is_used ? 1 : 0;
  }
  return leaf;
}

bool
isEqual(const Record& a, const Record& b)
{
  return std::equal(a.coordinates, a.coordinates + 3, b.coordinates);
}

/** Whether all points of a leaf equal two in the leaf before it: those have smaller
 * indices and show the tie, so the leaf is never needed. Without this, a query to a
 * million equal points would look at all of them. */
bool
isRedundant(const std::vector<Record>& records, std::size_t leaf)
{
  if (leaf == 0)
    return false;
  const auto first = records.begin() + static_cast<std::ptrdiff_t>(leaf * leaf_size);
  const auto last = records.end() - first > static_cast<std::ptrdiff_t>(leaf_size)
                        ? first + leaf_size
                        : records.end();
  const auto equals_first = [&first](const Record& other) {
    return isEqual(*first, other);
  };
  return std::all_of(first, last, equals_first) &&
         std::count_if(first - leaf_size, first, equals_first) >= 2;
}

Box
leafBox(const std::vector<Record>& records, std::size_t leaf, RepeatedPoints repeated)
{
  Box box;
  if (repeated == RepeatedPoints::LeftOut && isRedundant(records, leaf))
    return box;
  const std::size_t last = std::min(records.size(), (leaf + 1) * leaf_size);
  for (std::size_t i = leaf * leaf_size; i < last; ++i)
    box.include(records[i].coordinates, records[i].coordinates);
  return box;
}

Box
nodeBox(const Node& node)
{
  Box box;
  for (std::size_t child = 0; child < fan_out; ++child) {
    const float lower[] = {
        node.lower[0][child], node.lower[1][child], node.lower[2][child]};
    const float upper[] = {
        node.upper[0][child], node.upper[1][child], node.upper[2][child]};
    box.include(lower, upper);
  }
  return box;
}

void
setBox(Node& node, std::size_t child, const Box& box)
{
  const bool is_empty = !(box.lower[0] <= box.upper[0]);
  for (int axis = 0; axis < 3; ++axis) {
    node.lower[axis][child] = is_empty ? infinity : box.lower[axis];
    node.upper[axis][child] = is_empty ? -infinity : box.upper[axis];
  }
}

void
makeNodes(const std::vector<Record>& records,
          const Level& level,
          const Level& children,
          Storage& storage,
          RepeatedPoints repeated,
          int num_threads)
{
  const bool are_leaves = children.begin == storage.first_leaf;
#pragma omp parallel for num_threads(num_threads) schedule(static) if (are_leaves)
  for (std::size_t i = 0; i < level.size; ++i)
    for (std::size_t child = 0; child < fan_out; ++child) {
      const std::size_t below = fan_out * i + child;
      Box box;
      if (below < children.size)
        box = are_leaves ? leafBox(records, below, repeated)
                         : nodeBox(storage.nodes[children.begin + below]);
      setBox(storage.nodes[level.begin + i], child, box);
    }
}

void
makeLeaves(const std::vector<Record>& records, Storage& storage, int num_threads)
{
  const Record* last = records.data() + records.size();
#pragma omp parallel for num_threads(num_threads) schedule(static)
  for (std::size_t i = 0; i < storage.leaves.size(); ++i) {
    storage.leaves[i] = makeLeaf(records.data() + i * leaf_size, last);
    for (const std::uint32_t index : storage.leaves[i].index)
      if (index != no_leaf)
        storage.leaf_of[index] = static_cast<std::uint32_t>(i);
  }
}

} // namespace

Storage
build(const float* points,
      std::size_t num_points,
      int num_threads,
      RepeatedPoints repeated)
{
  std::vector<Record> records = finitePoints(points, num_points);
  const std::vector<Level> levels = levelsOf(records.size());
  num_threads = numThreadsFor(
      num_threads, static_cast<std::ptrdiff_t>(records.size()) / min_points_per_thread);

  Storage storage;
  storage.num_points = records.size();
  storage.first_leaf = static_cast<std::uint32_t>(levels.back().begin);
  storage.leaves.resize(levels.back().size);
  storage.leaf_of.assign(num_points, no_leaf);
  if (levels.size() > 1) {
    const Level& lowest = levels[levels.size() - 2];
    storage.nodes.resize(lowest.begin + lowest.size);
    storage.cells.resize(storage.nodes.size());
  }
  arrange(records, levels, storage.cells.data(), num_threads);
  makeLeaves(records, storage, num_threads);
  for (std::size_t depth = levels.size() - 1; depth > 0; --depth)
    makeNodes(
        records, levels[depth - 1], levels[depth], storage, repeated, num_threads);
  return storage;
}

} // namespace kd_tree
} // namespace bayesian_icp
