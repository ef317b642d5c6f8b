#include "calibrated/surface/even_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <unordered_map>

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

/** One point of each cube of side \p cube, the first one; no more than \p most + 1 of
 * them.
 * \param[in] points relative to the corner of the first cube */
void
firstOfEachCube(const Eigen::Matrix3Xf& points,
                float cube,
                Index most,
                SeenNumbers& seen,
                std::vector<Index>& columns)
{
  columns.clear();
  seen.forget();
  constexpr Index block_size = 256; // A loop without branches is vectorised.
  std::array<std::int32_t, 3 * block_size> places;
  for (Index begin = 0; begin < points.cols(); begin += block_size) {
    const Index size = std::min(block_size, points.cols() - begin);
    for (Index k = 0; k < 3 * size; ++k)
      places[static_cast<std::size_t>(k)] =
          static_cast<std::int32_t>(points.data()[3 * begin + k] / cube);
    for (Index i = 0; i < size; ++i) {
      std::uint64_t number = 0;
      for (int k = 0; k < 3; ++k)
        number = number << num_bits | static_cast<std::uint32_t>(
                                          places[static_cast<std::size_t>(3 * i + k)]);
      if (!seen.add(number))
        continue;
      columns.push_back(begin + i);
      if (static_cast<Index>(columns.size()) > most)
        return;
    }
  }
}

/** "Around" a point is in its cube and the 26 about that. A cube's side is the radius
 * in which an even sheet of the wanted number of points has some 30: in units of its
 * root mean square distance from its centroid, and of the square root of that number.
 */
constexpr double cube_of_sheet = 8.0;
constexpr int num_bisections = 60;

/** Cubes that hold points, in the order of their first points. */
class OccupiedCubes {
public:
  OccupiedCubes(const Eigen::Matrix3Xf& points, float cube)
  {
    const Eigen::Array3f low = points.rowwise().minCoeff();
    cube_of_.reserve(static_cast<std::size_t>(points.cols()));
    auto found = indices_.end();
    for (const auto& point : points.colwise()) {
      const Eigen::Array3f place = (point.array() - low) / cube;
      // Beyond the last cube there is a margin for neighbours.
      const auto number =
          numberOf(place.min(float(num_places - 3)).cast<std::int64_t>() + 1);
      // The points of a scan are near the ones before them.
      if (found == indices_.end() || found->first != number)
        found = indices_.emplace(number, counts_.size()).first;
      if (found->second == counts_.size()) {
        numbers_.push_back(number);
        counts_.push_back(0);
      }
      ++counts_[found->second];
      cube_of_.push_back(static_cast<std::uint32_t>(found->second));
    }
  }

  /** Points in a cube and the 26 about it, for every cube. */
  std::vector<double>
  crowds() const
  {
    std::vector<double> crowds;
    for (const std::uint64_t number : numbers_) {
      double crowd = 0.0;
      for (const std::int64_t x : {-1, 0, 1})
        for (const std::int64_t y : {-1, 0, 1})
          for (const std::int64_t z : {-1, 0, 1}) {
            const auto found = indices_.find(number + numberOf({x, y, z}));
            if (found != indices_.end())
              crowd += static_cast<double>(counts_[found->second]);
          }
      crowds.push_back(crowd);
    }
    return crowds;
  }

  const std::vector<Index>&
  counts() const
  {
    return counts_;
  }

  std::size_t
  cubeOf(Index point) const
  {
    return cube_of_[static_cast<std::size_t>(point)];
  }

private:
  static constexpr std::int64_t num_places = std::int64_t(1) << num_bits;

  /** Differences of places become differences of numbers, modulo 2^64. */
  static std::uint64_t
  numberOf(const Eigen::Array<std::int64_t, 3, 1>& place)
  {
    return static_cast<std::uint64_t>((place[0] * num_places + place[1]) * num_places +
                                      place[2]);
  }

  std::unordered_map<std::uint64_t, std::size_t> indices_;
  std::vector<std::uint64_t> numbers_;
  std::vector<Index> counts_;
  std::vector<std::uint32_t> cube_of_;
};

/** The c at which the sum of min(1, c / crowd) over all points is \p count. */
double
shareOf(const std::vector<Index>& counts,
        const std::vector<double>& crowds,
        double count)
{
  double low = 0.0, high = *std::max_element(crowds.begin(), crowds.end());
  for (int i = 0; i < num_bisections; ++i) {
    const double middle = 0.5 * (low + high);
    double sum = 0.0;
    for (std::size_t k = 0; k < counts.size(); ++k)
      sum += static_cast<double>(counts[k]) * std::min(1.0, middle / crowds[k]);
    (sum < count ? low : high) = middle;
  }
  return high;
}

std::vector<Index>
allOf(const Eigen::Matrix3Xf& points)
{
  std::vector<Index> columns(static_cast<std::size_t>(points.cols()));
  std::iota(columns.begin(), columns.end(), Index(0));
  return columns;
}

} // namespace

void
shuffle(std::vector<Index>& columns, Random& random)
{
  for (std::size_t i = columns.size(); i > 1; --i)
    std::swap(columns[i - 1], columns[random.index(i)]);
}

std::vector<Index>
evenlyThinned(const Eigen::Matrix3Xf& points, Index count)
{
  if (points.cols() <= count)
    return allOf(points);
  const Eigen::Matrix3Xd centred =
      points.cast<double>().colwise() - points.cast<double>().rowwise().mean();
  const double extent =
      std::sqrt(centred.squaredNorm() / static_cast<double>(points.cols()));
  const double cube = cube_of_sheet * extent / std::sqrt(static_cast<double>(count));
  const OccupiedCubes cubes(
      points, std::max(static_cast<float>(cube), std::numeric_limits<float>::min()));
  const std::vector<double> crowds = cubes.crowds();
  const double share = shareOf(cubes.counts(), crowds, static_cast<double>(count));
  Random random(1, 4);
  std::vector<Index> columns;
  for (Index i = 0; i < points.cols(); ++i)
    if (random.uniform() * crowds[cubes.cubeOf(i)] < share)
      columns.push_back(i);
  return columns;
}

std::vector<Index>
evenChoice(const Eigen::Matrix3Xf& points, Index count)
{
  std::vector<Index> order = allOf(points);
  if (points.cols() <= count)
    return order;
  // In a random order, the first point of a cube is a random one of it.
  Random random(1, 3);
  shuffle(order, random);
  const Eigen::Vector3f corner = points.rowwise().minCoeff();
  const double extent = double((points.rowwise().maxCoeff() - corner).maxCoeff());
  const Eigen::Matrix3Xf placed = points(Eigen::all, order).colwise() - corner;
  double low = extent * smallest_cube, high = 2.0 * extent;
  // A surface: the number of cubes goes with the square of their side.
  double cube = extent / std::sqrt(static_cast<double>(count));
  SeenNumbers seen(count + 1);
  // Places in the order. At random, should there be no grid: all in one place, or too
  // far apart.
  std::vector<Index> places, best(static_cast<std::size_t>(count));
  std::iota(best.begin(), best.end(), Index(0));
  for (int trial = 0; trial < max_trials && low < high && std::isfinite(extent);
       ++trial) {
    firstOfEachCube(placed, static_cast<float>(cube), count, seen, places);
    const auto found = static_cast<Index>(places.size());
    if (found > count) {
      low = cube;
    }
    else {
      high = cube;
      best = places;
      if (static_cast<double>(found) >= wanted_part * static_cast<double>(count))
        break;
    }
    // Where too many are found, how many there are is not known.
    const double guess =
        found > count ? 1.3 * cube : cube * std::sqrt(double(found) / double(count));
    cube = guess > low && guess < high ? guess : std::sqrt(low * high);
  }
  for (Index& place : best)
    place = order[static_cast<std::size_t>(place)];
  std::sort(best.begin(), best.end());
  return best;
}

} // namespace bayesian_icp
