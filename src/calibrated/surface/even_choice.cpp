#include "calibrated/surface/even_choice.h"

#include <Eigen/Geometry>

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

/** A grid is fine enough if it yields wanted_part of the wanted number of points. The
 * next grid to be tried should yield best_part of it. */
constexpr double wanted_part = 0.97, best_part = 0.985;
constexpr int max_trials = 24;

/** Number of bits of a cube's place on each axis, which limits the smallest cube that
 * is tried, as a fraction of the cloud's extent. */
constexpr int num_bits = 21;
constexpr double smallest_cube = 1.0 / (1 << 20);

/** The points that are chosen from cubes: in each cube the point with the smallest
 * rank, which is random. */
class ChosenOfCubes {
public:
  /** \param[in] most maximum number of cubes
   * \param[in] stream of the ranks */
  ChosenOfCubes(Index most, ChoiceStream stream)
  : first_rank_((1 + static_cast<std::uint32_t>(stream)) * 0x9e3779b9)
  {
    std::size_t size = 4;
    while (size < 2 * static_cast<std::size_t>(most))
      size *= 2;
    slots_.resize(size);
  }

  void
  clear()
  {
    std::fill(slots_.begin(), slots_.end(), Slot());
    num_cubes_ = 0;
  }

  void
  add(std::uint64_t cube, std::uint32_t point)
  {
    // Fibonacci hashing, whose high bits depend on all axes, and the next free slot.
    const std::size_t mask = slots_.size() - 1;
    std::size_t place = (cube * golden_ratio >> 34) & mask;
    while (slots_[place].cube != none && slots_[place].cube != cube)
      place = (place + 1) & mask;
    Slot& slot = slots_[place];
    num_cubes_ += slot.cube == none;
    const std::uint32_t rank = rankOf(point);
    if (slot.cube == none || rank < slot.rank)
      slot = {cube, rank, point};
  }

  Index
  numCubes() const
  {
    return num_cubes_;
  }

  /** The chosen points in ascending order.
   * \param[in] num_points number of points that were added */
  std::vector<Index>
  points(Index num_points) const
  {
    std::vector<char> is_chosen(static_cast<std::size_t>(num_points));
    for (const Slot& slot : slots_)
      if (slot.cube != none)
        is_chosen[slot.point] = 1;
    std::vector<Index> points;
    points.reserve(static_cast<std::size_t>(num_cubes_));
    for (std::size_t i = 0; i < is_chosen.size(); ++i)
      if (is_chosen[i])
        points.push_back(static_cast<Index>(i));
    return points;
  }

private:
  static constexpr std::uint64_t none = ~std::uint64_t(0);
  static constexpr std::uint64_t golden_ratio = 0x9e3779b97f4a7c15;

  struct Slot {
    std::uint64_t cube = none;
    std::uint32_t rank = 0;
    std::uint32_t point = 0;
  };

  /** The finalizer of MurmurHash3: no two points have the same rank. */
  std::uint32_t
  rankOf(std::uint32_t point) const
  {
    std::uint32_t rank = point + first_rank_;
    rank = (rank ^ rank >> 16) * 0x85ebca6b;
    rank = (rank ^ rank >> 13) * 0xc2b2ae35;
    return rank ^ rank >> 16;
  }

  std::uint32_t first_rank_;
  std::vector<Slot> slots_;
  Index num_cubes_ = 0;
};

/** Choose a point of each cube of side \p cube, until there are more than \p most.
 * \param[in] corner of the first cube
 * \return number of points that were examined */
Index
chooseOfCubes(const Eigen::Matrix3Xf& points,
              const Eigen::Vector3f& corner,
              float cube,
              Index most,
              ChosenOfCubes& chosen)
{
  chosen.clear();
  constexpr Index block_size = 256; // A loop without branches is vectorised.
  std::array<std::int32_t, 3 * block_size> places;
  Index begin = 0;
  for (; begin < points.cols() && chosen.numCubes() <= most; begin += block_size) {
    const Index size = std::min(block_size, points.cols() - begin);
    Eigen::Map<Eigen::Matrix<std::int32_t, 3, Eigen::Dynamic>>(places.data(), 3, size) =
        ((points.middleCols(begin, size).colwise() - corner) / cube)
            .cast<std::int32_t>();
    for (Index i = 0; i < size && chosen.numCubes() <= most; ++i) {
      std::uint64_t number = 0;
      for (int k = 0; k < 3; ++k)
        number = number << num_bits | static_cast<std::uint32_t>(
                                          places[static_cast<std::size_t>(3 * i + k)]);
      chosen.add(number, static_cast<std::uint32_t>(begin + i));
    }
  }
  return std::min(begin, points.cols());
}

/** Points "around" a point are in its cube and the 26 cubes about it. The side of a
 * cube is the radius in which an even sheet of the wanted number of points has some 30
 * of them. It is in units of the sheet's root mean square distance from its centroid
 * over the square root of that number. */
constexpr double cube_of_sheet = 8.0;
/** A point with fewer points around it than the first number, itself included, is
 * isolated; with fewer than the second, it is sparse. An even sheet has about 92. */
constexpr double min_crowd = 5.0, sparse_crowd = 20.0;
constexpr int num_bisections = 60;

/** Side of the cubes around points of a sheet that is thinned to \p count points. */
float
cubeOfSheet(const Eigen::Matrix3Xf& points, Index count)
{
  const double cube =
      cube_of_sheet * spreadOf(points) / std::sqrt(static_cast<double>(count));
  using Limits = std::numeric_limits<float>;
  return static_cast<float>(std::clamp<double>(cube, Limits::min(), Limits::max()));
}

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

  /** Points in a cube and the 26 around it, for every cube; counting ends where there
   * are \p enough. */
  std::vector<double>
  crowds(double enough = std::numeric_limits<double>::infinity()) const
  {
    std::vector<std::uint64_t> neighbors;
    for (const std::int64_t x : {-1, 0, 1})
      for (const std::int64_t y : {-1, 0, 1})
        for (const std::int64_t z : {-1, 0, 1})
          neighbors.push_back(numberOf({x, y, z}));
    std::vector<double> crowds(numbers_.size());
    for (std::size_t cube = 0; cube < crowds.size(); ++cube)
      for (auto n = neighbors.begin(); n != neighbors.end() && crowds[cube] < enough;
           ++n) {
        const auto found = indices_.find(numbers_[cube] + *n);
        if (found != indices_.end())
          crowds[cube] += static_cast<double>(counts_[found->second]);
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

double
spreadOf(const Eigen::Matrix3Xf& points)
{
  const Eigen::Vector3d centroid = points.cast<double>().rowwise().mean();
  double sum = 0.0;
  for (const auto& point : points.colwise())
    sum += (point.cast<double>() - centroid).squaredNorm();
  return std::sqrt(sum / static_cast<double>(points.cols()));
}

double
extentOf(const Eigen::Matrix3Xd& points)
{
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

void
shuffle(std::vector<Index>& columns, Random& random)
{
  for (std::size_t i = columns.size(); i > 1; --i)
    std::swap(columns[i - 1], columns[random.index(i)]);
}

std::vector<Index>
withoutStray(const Eigen::Matrix3Xf& points, Index count)
{
  const OccupiedCubes cubes(points,
                            cubeOfSheet(points, std::min(points.cols(), count)));
  const std::vector<double> crowds = cubes.crowds(sparse_crowd);
  std::vector<Index> columns;
  Index num_sparse = 0;
  for (Index i = 0; i < points.cols(); ++i) {
    const double crowd = crowds[cubes.cubeOf(i)];
    if (crowd >= min_crowd)
      columns.push_back(i);
    num_sparse += crowd >= min_crowd && crowd < sparse_crowd;
  }
  const Index num_isolated = points.cols() - static_cast<Index>(columns.size());
  return num_isolated > num_sparse ? columns : allOf(points);
}

std::vector<Index>
evenlyThinned(const Eigen::Matrix3Xf& points, Index count)
{
  if (points.cols() <= count)
    return allOf(points);
  const OccupiedCubes cubes(points, cubeOfSheet(points, count));
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
evenChoice(Eigen::Matrix3Xf points, Index count, ChoiceStream stream)
{
  if (points.cols() <= count)
    return allOf(points);
  // A rotation of the grid that brings no axis near another one.
  const Eigen::Matrix3f R =
      Eigen::Quaternionf(0.5F, 0.31F, -0.7F, 0.4F).normalized().toRotationMatrix();
  for (auto point : points.colwise())
    point = (R * point).eval();
  const Eigen::Vector3f corner = points.rowwise().minCoeff();
  const double extent = double((points.rowwise().maxCoeff() - corner).maxCoeff());
  double low = extent * smallest_cube, high = 2.0 * extent;
  // On a surface the number of cubes goes with the square of their side, with a smaller
  // power where most points have cubes of their own.
  double cube = extent / std::sqrt(static_cast<double>(count)), exponent = -2.0;
  double last_cube = 0.0, last_found = 0.0;
  ChosenOfCubes chosen(count + 1, stream);
  std::vector<Index> best;
  for (int trial = 0; trial < max_trials && low < high && std::isfinite(extent);
       ++trial) {
    const Index num_seen =
        chooseOfCubes(points, corner, static_cast<float>(cube), count, chosen);
    const double found =
        static_cast<double>(chosen.numCubes()) *
        (static_cast<double>(points.cols()) / static_cast<double>(num_seen));
    if (chosen.numCubes() > count) {
      low = cube;
    }
    else {
      high = cube;
      best = chosen.points(points.cols());
      if (found >= wanted_part * static_cast<double>(count))
        break;
    }
    if (trial > 0 && cube != last_cube)
      exponent = std::clamp(
          std::log(found / last_found) / std::log(cube / last_cube), -3.0, -0.1);
    last_cube = cube;
    last_found = found;
    const double guess =
        cube * std::pow(best_part * static_cast<double>(count) / found, 1.0 / exponent);
    cube = guess > low && guess < high ? guess : std::sqrt(low * high);
  }
  if (!best.empty())
    return best;
  // There is no grid: all points are in one place, or too far apart.
  best = allOf(points);
  Random random(1, 3);
  shuffle(best, random);
  best.resize(static_cast<std::size_t>(count));
  std::sort(best.begin(), best.end());
  return best;
}

} // namespace bayesian_icp
