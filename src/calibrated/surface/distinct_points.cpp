#include "calibrated/surface/distinct_points.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace bayesian_icp {

Eigen::Matrix3Xd
distinctPoints(const Eigen::Matrix3Xd& points)
{
  std::vector<Eigen::Index> order;
  order.reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    if (points.col(i).allFinite())
      order.push_back(i);
  const auto isSame = [&points](Eigen::Index a, Eigen::Index b) {
    return points.col(a) == points.col(b);
  };
  std::sort(order.begin(), order.end(), [&points](Eigen::Index a, Eigen::Index b) {
    for (int k = 0; k < 3; ++k)
      if (points(k, a) != points(k, b))
        return points(k, a) < points(k, b);
    return a < b;
  });
  order.erase(std::unique(order.begin(), order.end(), isSame), order.end());
  std::sort(order.begin(), order.end());
  return points(Eigen::all, order);
}

} // namespace bayesian_icp
