#include <bayesian_icp/random.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace bayesian_icp {

namespace {

std::mt19937_64
engineOf(std::uint64_t seed, std::uint64_t stream)
{
  std::seed_seq sequence{static_cast<std::uint32_t>(seed),
                         static_cast<std::uint32_t>(seed >> 32),
                         static_cast<std::uint32_t>(stream),
                         static_cast<std::uint32_t>(stream >> 32)};
  return std::mt19937_64(sequence);
}

} // namespace

Random::Random(std::uint64_t seed, std::uint64_t stream)
: engine_(engineOf(seed, stream))
{}

double
Random::uniform()
{
  return static_cast<double>(engine_() >> 11) * 0x1.0p-53;
}

std::size_t
Random::index(std::size_t bound)
{
  // Reject the incomplete last block, so that every index is equally likely.
  const std::uint64_t range = std::numeric_limits<std::uint64_t>::max();
  const std::uint64_t limit = range - range % bound;
  std::uint64_t value = engine_();
  while (value >= limit)
    value = engine_();
  return static_cast<std::size_t>(value % bound);
}

double
Random::normal()
{
  if (has_spare_normal_) {
    has_spare_normal_ = false;
    return spare_normal_;
  }
  double u = 0.0, v = 0.0, square = 0.0;
  do {
    u = 2.0 * uniform() - 1.0;
    v = 2.0 * uniform() - 1.0;
    square = u * u + v * v;
  }
  while (square >= 1.0 || square == 0.0);
  const double factor = std::sqrt(-2.0 * std::log(square) / square);
  spare_normal_ = v * factor;
  has_spare_normal_ = true;
  return u * factor;
}

Eigen::Matrix<double, 6, 1>
Random::normal6()
{
  Eigen::Matrix<double, 6, 1> z;
  for (int k = 0; k < 6; ++k)
    z[k] = normal();
  return z;
}

std::vector<Eigen::Index>
randomChoice(Eigen::Index count, Eigen::Index size, Random& random)
{
  std::vector<Eigen::Index> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), Eigen::Index(0));
  const auto num_chosen = static_cast<std::size_t>(std::min(count, size));
  for (std::size_t i = 0; i < num_chosen; ++i)
    std::swap(order[i], order[i + random.index(order.size() - i)]);
  order.resize(num_chosen);
  return order;
}

} // namespace bayesian_icp
