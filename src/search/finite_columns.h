/** \file
 * \brief Which points of a cloud are finite.
 */
#pragma once

#include <Eigen/Core>

#include <vector>

namespace bayesian_icp {

/** \brief The columns of \p points whose coordinates are all finite, in their order.
 * \param[in] points 3 x n */
template <typename Points>
std::vector<Eigen::Index>
finiteColumns(const Points& points)
{
  std::vector<Eigen::Index> columns;
  columns.reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    if (points.col(i).allFinite())
      columns.push_back(i);
  return columns;
}

} // namespace bayesian_icp
