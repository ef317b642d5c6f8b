#include "kd_tree_arrange.h"

namespace bayesian_icp {
namespace kd_tree {
namespace {

/** Runs of fewer points are not worth a task of their own. */
constexpr std::size_t min_task_size = 8192;

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

/** Puts points in order and fills the cells. */
class Arrangement {
public:
  Arrangement(std::vector<Record>& records,
              const std::vector<Level>& levels,
              Cell* cells)
  : records_(records.data())
  , levels_(levels)
  , cells_(cells)
  {}

  /** Order a run such that all subtrees in it are runs.
   * \param[in] depth of the smallest subtree known to contain the run
   * \param[in] cell the part of space that belongs to the run */
  void
  arrange(Record* first, Record* last, std::size_t depth, Cell cell) const;

private:
  Record* records_;
  const std::vector<Level>& levels_;
  Cell* cells_;
};

void
Arrangement::arrange(Record* first, Record* last, std::size_t depth, Cell cell) const
{
  const auto size = static_cast<std::size_t>(last - first);
  for (; size <= levels_[depth].subtree_size; ++depth) {
    if (depth + 1 == levels_.size()) {
      std::sort(first, last, [](const Record& a, const Record& b) {
        return a.index < b.index;
      });
      return;
    }
    const auto place = static_cast<std::size_t>(first - records_);
    cells_[levels_[depth].begin + place / levels_[depth].subtree_size] = cell;
  }
  const std::size_t child_size = levels_[depth].subtree_size;
  const std::size_t num_children = (size + child_size - 1) / child_size;
  Record* middle = first + child_size * ((num_children + 1) / 2);
  const int axis = widestAxis(first, last);
  std::nth_element(first, middle, last, IsBefore{axis});
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

} // namespace

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

void
arrange(std::vector<Record>& records,
        const std::vector<Level>& levels,
        Cell* cells,
        int num_threads)
{
  const Arrangement arrangement(records, levels, cells);
  const Cell everywhere{{-infinity, -infinity, -infinity},
                        {infinity, infinity, infinity}};
#pragma omp parallel num_threads(num_threads)
#pragma omp single
  arrangement.arrange(records.data(), records.data() + records.size(), 0, everywhere);
}

} // namespace kd_tree
} // namespace bayesian_icp
