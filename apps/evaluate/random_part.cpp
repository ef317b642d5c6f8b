#include "random_part.h"

#include <algorithm>
#include <numeric>

namespace bayesian_icp::evaluate {

std::vector<Eigen::Index>
randomPart(Eigen::Index count, Eigen::Index size, Random& random)
{
  std::vector<Eigen::Index> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  const auto num_taken = static_cast<std::size_t>(std::min(count, size));
  for (std::size_t i = 0; i < num_taken; ++i)
    std::swap(order[i], order[i + random.index(order.size() - i)]);
  order.resize(num_taken);
  return order;
}

} // namespace bayesian_icp::evaluate
