// Building the tree of KdTree. The points are put in an order in which every leaf is a
// run of 16 and every subtree a run of 16 * 8^height points; what is left over makes
// the last leaf, and the last subtree of every height, smaller. So the shape of the
// tree follows from the number of points alone, and nodes need no pointers.
#include "kd_tree_build.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp {
namespace kd_tree {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

/** Runs of fewer points are not worth a task of their own. */
constexpr std::size_t min_task_size = 8192;

struct Record {
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

/** Points along an axis, equal coordinates by index: makes the order of the points, and
 * so the tree, unique. It also puts the smaller index of two equal points to the left
 * wherever they are separated. */
struct IsBefore {
  int axis;

  bool
  operator()(const Record& a, const Record& b) const
  {
    return a.coordinates[axis] < b.coordinates[axis] ||
           (a.coordinates[axis] == b.coordinates[axis] && a.index < b.index);
  }
};

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

int
widestAxis(const Record* first, const Record* last)
{
  Box box;
  for (; first != last; ++first)
    box.include(first->coordinates, first->coordinates);
  int widest = 0;
  // Halves, because the whole width may overflow.
  const auto half_width = [&box](int axis) {
    return box.upper[axis] / 2 - box.lower[axis] / 2;
  };
  for (int axis = 1; axis < 3; ++axis)
    if (half_width(axis) > half_width(widest))
      widest = axis;
  return widest;
}

/** Order a run such that all subtrees in it are runs.
 * \param[in] child_size a power of 8 times 16, the points of a subtree that is full */
void
arrange(Record* first, Record* last, std::size_t child_size)
{
  const auto size = static_cast<std::size_t>(last - first);
  if (size <= leaf_size) {
    std::sort(first, last, [](const Record& a, const Record& b) {
      return a.index < b.index;
    });
    return;
  }
  while (child_size >= size)
    child_size /= fan_out;
  const std::size_t num_children = (size + child_size - 1) / child_size;
  Record* middle = first + child_size * ((num_children + 1) / 2);
  std::nth_element(first, middle, last, IsBefore{widestAxis(first, last)});
  if (size > min_task_size) {
#pragma omp task
    arrange(first, middle, child_size);
  }
  else {
    arrange(first, middle, child_size);
  }
  arrange(middle, last, child_size);
}

Leaf
makeLeaf(const Record* first, const Record* last)
{
  Leaf leaf;
  for (std::size_t i = 0; i < leaf_size; ++i, ++first) {
    const bool is_used = first < last;
    for (int axis = 0; axis < 3; ++axis)
      leaf.coordinates[axis][i] = is_used ? first->coordinates[axis] : infinity;
    leaf.index[i] = is_used ? first->index : std::numeric_limits<std::uint32_t>::max();
  }
  return leaf;
}

bool
isEqual(const Record& a, const Record& b)
{
  return std::equal(a.coordinates, a.coordinates + 3, b.coordinates);
}

/** Whether all points of a leaf equal one in the leaf before it: that one has a smaller
 * index, so the leaf is never needed. Without this, a query as near to a million equal
 * points as to one would look at all of them. */
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
         std::any_of(first - leaf_size, first, equals_first);
}

Box
leafBox(const std::vector<Record>& records, std::size_t leaf)
{
  Box box;
  if (isRedundant(records, leaf))
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

/** The nodes, or the leaves, of the same depth. */
struct Level {
  /** Number of the first one. */
  std::size_t begin;
  /** How many there are; they are the first ones of the complete level. */
  std::size_t size;
};

/** From the root to the leaves. */
std::vector<Level>
levels(std::size_t num_leaves)
{
  std::size_t depth = 0;
  for (std::size_t capacity = 1; capacity < num_leaves; capacity *= fan_out)
    ++depth;
  std::vector<Level> levels(depth + 1, {0, num_leaves});
  for (std::size_t d = depth; d > 0; --d)
    levels[d - 1].size = (levels[d].size + fan_out - 1) / fan_out;
  for (std::size_t d = 1; d <= depth; ++d)
    levels[d].begin = fan_out * levels[d - 1].begin + 1;
  return levels;
}

void
makeNodes(const std::vector<Record>& records,
          const Level& level,
          const Level& children,
          Storage& storage,
          int num_threads)
{
  const bool are_leaves = children.begin == storage.first_leaf;
#pragma omp parallel for num_threads(num_threads) schedule(static)
  for (std::size_t i = 0; i < level.size; ++i)
    for (std::size_t child = 0; child < fan_out; ++child) {
      const std::size_t below = fan_out * i + child;
      Box box;
      if (below < children.size)
        box = are_leaves ? leafBox(records, below)
                         : nodeBox(storage.nodes[children.begin + below]);
      setBox(storage.nodes[level.begin + i], child, box);
    }
}

void
arrangeInParallel(std::vector<Record>& records, std::size_t child_size, int num_threads)
{
#pragma omp parallel num_threads(num_threads)
#pragma omp single
  arrange(records.data(), records.data() + records.size(), child_size);
}

} // namespace

Storage
build(const float* points, std::size_t num_points, int num_threads)
{
  std::vector<Record> records = finitePoints(points, num_points);
  const std::size_t num_leaves =
      std::max<std::size_t>((records.size() + leaf_size - 1) / leaf_size, 1);
  const std::vector<Level> levels = kd_tree::levels(num_leaves);

  std::size_t child_size = leaf_size;
  for (std::size_t depth = 1; depth < levels.size(); ++depth)
    child_size *= fan_out;
  arrangeInParallel(records, child_size, num_threads);

  Storage storage;
  storage.num_points = records.size();
  storage.first_leaf = static_cast<std::uint32_t>(levels.back().begin);
  storage.leaves.resize(num_leaves);
#pragma omp parallel for num_threads(num_threads) schedule(static)
  for (std::size_t i = 0; i < num_leaves; ++i)
    storage.leaves[i] =
        makeLeaf(records.data() + i * leaf_size, records.data() + records.size());
  if (levels.size() > 1) {
    const Level& lowest = levels[levels.size() - 2];
    storage.nodes.resize(lowest.begin + lowest.size);
  }
  for (std::size_t depth = levels.size() - 1; depth > 0; --depth)
    makeNodes(records, levels[depth - 1], levels[depth], storage, num_threads);
  return storage;
}

} // namespace kd_tree
} // namespace bayesian_icp
