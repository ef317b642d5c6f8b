#include "even_choice.h"

#include <bayesian_icp/random.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace bayesian_icp {

using Eigen::Index;

namespace {

/** A grid is fine enough if it yields this part of the wanted number of points. */
constexpr double wanted_part = 0.97;
constexpr int max_trials = 24;

/** Bits of a cube's place on each axis, and so the smallest cube that is tried, in
 * parts of the cloud's extent. */
constexpr int num_bits = 21;
constexpr double smallest_cube = 1.0 / (1 << 20);

/** Numbers that have been seen, up to a certain count of them. */
class SeenNumbers {
public:
  explicit SeenNumbers(Index most)
  {
    std::size_t size = 4;
    while (size < 2 * static_cast<std::size_t>(most))
      size *= 2;
    slots_.resize(size);
  }

  void
  forget()
  {
    std::fill(slots_.begin(), slots_.end(), none);
  }

  /** Whether \p number is new; it no longer is. */
  bool
  add(std::uint64_t number)
  {
    // Fibonacci hashing, and the next free slot.
    constexpr std::uint64_t golden_ratio = 0x9e3779b97f4a7c15;
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = (number * golden_ratio >> 20) & mask;
    while (slots_[slot] != none && slots_[slot] != number)
      slot = (slot + 1) & mask;
    const bool is_new = slots_[slot] == none;
    slots_[slot] = number;
    return is_new;
  }

private:
  static constexpr std::uint64_t none = ~std::uint64_t(0);
  std::vector<std::uint64_t> slots_;
};

/** One point of each cube of side \p cube, the first one in \p order; no more than
 * \p most + 1 of them. */
void
firstOfEachCube(const Eigen::Matrix3Xf& points,
                const std::vector<Index>& order,
                float cube,
                Index most,
                SeenNumbers& seen,
                std::vector<Index>& columns)
{
  const Eigen::Array3f low = points.rowwise().minCoeff();
  columns.clear();
  seen.forget();
  for (const Index column : order) {
    const Eigen::Array3f place = (points.col(column).array() - low) / cube;
    std::uint64_t number = 0;
    for (int k = 0; k < 3; ++k)
      number = number << num_bits | static_cast<std::uint64_t>(place[k]);
    if (!seen.add(number))
      continue;
    columns.push_back(column);
    if (static_cast<Index>(columns.size()) > most)
      return;
  }
}

} // namespace

std::vector<Index>
evenChoice(const Eigen::Matrix3Xf& points, Index count)
{
  std::vector<Index> order(static_cast<std::size_t>(points.cols()));
  std::iota(order.begin(), order.end(), Index(0));
  if (points.cols() <= count)
    return order;
  // In a random order, the first point of a cube is a random one of it.
  Random random(1, 3);
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[random.index(i)]);
  const double extent =
      double((points.rowwise().maxCoeff() - points.rowwise().minCoeff()).maxCoeff());
  double low = extent * smallest_cube, high = 2.0 * extent;
  // A surface: the number of cubes goes with the square of their side.
  double cube = extent / std::sqrt(static_cast<double>(count));
  SeenNumbers seen(count + 1);
  // At random, should there be no grid: all in one place, or too far apart.
  std::vector<Index> columns, best(order.begin(), order.begin() + count);
  for (int trial = 0; trial < max_trials && low < high && std::isfinite(extent);
       ++trial) {
    firstOfEachCube(points, order, static_cast<float>(cube), count, seen, columns);
    const auto found = static_cast<Index>(columns.size());
    if (found > count) {
      low = cube;
    }
    else {
      high = cube;
      best = columns;
      if (static_cast<double>(found) >= wanted_part * static_cast<double>(count))
        break;
    }
    // Where too many are found, how many there are is not known.
    const double guess =
        found > count ? 1.3 * cube : cube * std::sqrt(double(found) / double(count));
    cube = guess > low && guess < high ? guess : std::sqrt(low * high);
  }
  std::sort(best.begin(), best.end());
  return best;
}

} // namespace bayesian_icp
