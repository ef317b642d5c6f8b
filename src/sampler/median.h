/** \file
 * \brief The median of numbers.
 */
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace bayesian_icp {

/** \brief The median; the upper of the two middle numbers if their count is even, and 0
 * if there are none. */
inline double
medianOf(std::vector<double> values)
{
  if (values.empty())
    return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

} // namespace bayesian_icp
