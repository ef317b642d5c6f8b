/** \file
 * \brief Numbers for pictures: round ones, and a few of many.
 */
#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <vector>

namespace bayesian_icp::io {

/** \brief The least of 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8 times a power of ten that is not
 * below \p value; 1e-6 if that is not positive. */
inline double
roundedUp(double value)
{
  if (!(value > 0.0))
    return 1e-6;
  // A value that is round itself may be a rounding above it.
  constexpr double tolerance = 1.0 - 1e-12;
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0})
    if (value * tolerance <= factor * decade)
      return factor * decade;
  return 10.0 * decade;
}

/** \brief At most \p max_count, which is at least 1, of the indices 0 ... \p count - 1:
 * evenly spaced, the first one among them. Of chains one after the other, each chain
 * gets its share. */
inline std::vector<Eigen::Index>
evenlySpaced(Eigen::Index count, Eigen::Index max_count)
{
  const Eigen::Index size = std::min(count, std::max<Eigen::Index>(max_count, 1));
  std::vector<Eigen::Index> indices;
  for (Eigen::Index i = 0; i < size; ++i)
    indices.push_back(i * count / size);
  return indices;
}

} // namespace bayesian_icp::io
