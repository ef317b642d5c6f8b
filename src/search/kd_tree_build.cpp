// Every leaf is a run of 16 points and every subtree a run of 16 * 8^height points;
// what is left over makes the last leaf, and the last subtree of every height, smaller.
// So the shape of the tree follows from the number of points alone, and nodes need no
// pointers.
#include "search/kd_tree_build.h"

#include "threads/for_each_piece.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp::kd_tree {
namespace {

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

/** Smallest run of points that gets a task of its own. */
constexpr std::size_t min_task_size = 8192;

/** Points along an axis, equal coordinates by index: makes the order of the points, and
 * so the tree, unique. It also puts the smaller index of two equal points to the left
 * wherever they are separated. */
struct IsBefore {
  int axis;

  bool
  operator()(const Record& a, const Record& b) const
  {
    const float x = a.coordinates[axis];
    const float y = b.coordinates[axis];
    return (x < y) | ((x == y) & (a.index < b.index));
  }
};

/** A record that probably is a little beyond \p nth, on the side where there are more:
 * the two rounds that select() then needs are over the whole run and half of it. */
Record
choosePivot(const Record* first, const Record* nth, const Record* last, IsBefore before)
{
  constexpr std::size_t max_sample_size = 64;
  const auto size = static_cast<std::size_t>(last - first);
  const std::size_t sample_size = size < 256 ? 7 : size < 2048 ? 16 : max_sample_size;
  Record sample[max_sample_size];
  for (std::size_t i = 0; i < sample_size; ++i)
    sample[i] = first[i * (size / sample_size)];
  const auto rank = static_cast<std::size_t>(nth - first) * sample_size / size;
  const std::size_t margin = std::max<std::size_t>(sample_size / 8, 1);
  const std::size_t pivot = rank < sample_size / 2 ? rank + margin : rank - margin;
  std::nth_element(sample, sample + pivot, sample + sample_size, before);
  return sample[pivot];
}

/** Like std::nth_element, but without a branch that depends on the points: these cannot
 * be predicted and take most of its time. No two records are equal. */
void
select(Record* first, Record* nth, Record* last, IsBefore before)
{
  constexpr std::ptrdiff_t small_size = 16;
  // Pivots may be bad, but rarely that often; std::nth_element has its own guard.
  constexpr int max_rounds = 64;
  for (int round = 0; last - first > small_size && round < max_rounds; ++round) {
    const Record pivot = choosePivot(first, nth, last, before);
    Record* end_before = first;
    for (Record* record = first; record != last; ++record) {
      const Record moved = *record;
      *record = *end_before;
      *end_before = moved;
      end_before += before(moved, pivot);
    }
    if (nth < end_before)
      last = end_before;
    else
      first = end_before;
  }
  std::nth_element(first, nth, last, before);
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

/** Puts points in the order of the tree. */
struct Arrangement {
  Record* records;
  const std::vector<Level>& levels;
  /** Of the nodes, by their numbers; they are filled. */
  Cell* cells;

  /** Order a run such that all subtrees in it are runs.
   * \param[in] depth of the smallest subtree known to contain the run
   * \param[in] cell the part of space that belongs to the run */
  void
  arrange(Record* first, Record* last, std::size_t depth, Cell cell) const
  {
    const auto size = static_cast<std::size_t>(last - first);
    for (; size <= levels[depth].subtree_size; ++depth) {
      if (depth + 1 == levels.size()) {
        std::sort(first, last, [](const Record& a, const Record& b) {
          return a.index < b.index;
        });
        return;
      }
      const auto place = static_cast<std::size_t>(first - records);
      cells[levels[depth].begin + place / levels[depth].subtree_size] = cell;
    }
    const std::size_t child_size = levels[depth].subtree_size;
    const std::size_t num_children = (size + child_size - 1) / child_size;
    Record* middle = first + child_size * ((num_children + 1) / 2);
    const int axis = widestAxis(first, last);
    select(first, middle, last, IsBefore{axis});
    Cell left = cell;
    left.upper[axis] = middle->coordinates[axis];
    cell.lower[axis] = middle->coordinates[axis];
    if (size > min_task_size) {
#pragma omp task
      arrange(first, middle, depth, left);
    }
    else {
      arrange(first, middle, depth, left);
    }
    arrange(middle, last, depth, cell);
  }
};

/** The levels from the root to the leaves of a tree of \p num_points points. */
std::vector<Level>
levelsOf(std::size_t num_points)
{
  const std::size_t num_leaves =
      std::max<std::size_t>((num_points + leaf_size - 1) / leaf_size, 1);
  std::size_t depth = 0;
  for (std::size_t capacity = 1; capacity < num_leaves; capacity *= fan_out)
    ++depth;
  std::vector<Level> levels(depth + 1, {0, num_leaves, leaf_size});
  for (std::size_t d = depth; d > 0; --d) {
    levels[d - 1].size = (levels[d].size + fan_out - 1) / fan_out;
    levels[d - 1].subtree_size = fan_out * levels[d].subtree_size;
  }
  for (std::size_t d = 1; d <= depth; ++d)
    levels[d].begin = fan_out * levels[d - 1].begin + 1;
  return levels;
}

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
    return std::equal(first->coordinates, first->coordinates + 3, other.coordinates);
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
  const Arrangement arrangement{records.data(), levels, storage.cells.data()};
  const Cell everywhere{{-infinity, -infinity, -infinity},
                        {infinity, infinity, infinity}};
#pragma omp parallel num_threads(num_threads)
#pragma omp single
  arrangement.arrange(records.data(), records.data() + records.size(), 0, everywhere);
  makeLeaves(records, storage, num_threads);
  for (std::size_t depth = levels.size() - 1; depth > 0; --depth)
    makeNodes(
        records, levels[depth - 1], levels[depth], storage, repeated, num_threads);
  return storage;
}

} // namespace bayesian_icp::kd_tree
