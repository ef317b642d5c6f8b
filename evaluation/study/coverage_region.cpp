#include "study/coverage_region.h"

#include <boost/math/distributions/chi_squared.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace bayesian_icp::evaluate {

namespace {

/** Nodes of the midpoint rule over a chi-square variable: quantiles of equal weight.
 * With no degree of freedom it is zero. */
std::vector<double>
nodesOf(int degrees_of_freedom)
{
  constexpr int num_nodes = 64;
  if (degrees_of_freedom == 0)
    return {0.0};
  const boost::math::chi_squared distribution(degrees_of_freedom);
  std::vector<double> nodes(num_nodes);
  for (int i = 0; i < num_nodes; ++i)
    nodes[i] = boost::math::quantile(distribution, (i + 0.5) / num_nodes);
  return nodes;
}

/** Of \p distance or less. */
double
chiSquaredProbability(int degrees_of_freedom, double distance)
{
  return boost::math::cdf(boost::math::chi_squared(degrees_of_freedom),
                          std::max(0.0, distance));
}

} // namespace

double
regionOf(double nees, const RegionShape& shape)
{
  if (!std::isfinite(nees))
    return nees;
  const int nu = shape.degrees_of_freedom, k = shape.num_held;
  if (nu == 0 || k == 0)
    return chiSquaredProbability(6, nees);
  // P(w X + Y < nees), X and Y chi-square with k and 6 - k degrees of freedom.
  const std::vector<double> scales = nodesOf(nu), others = nodesOf(6 - k);
  double sum = 0.0;
  for (const double scale : scales)
    for (const double other : others)
      sum += chiSquaredProbability(k, (nees - other) * scale / (nu - 2));
  return sum / static_cast<double>(scales.size() * others.size());
}

} // namespace bayesian_icp::evaluate
