#include "search/kd_tree_arrange.h"

namespace bayesian_icp {
namespace kd_tree {
namespace {

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
