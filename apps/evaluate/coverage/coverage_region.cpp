#include "coverage_region.h"

#include <boost/math/distributions/chi_squared.hpp>

#include <algorithm>
#include <cmath>

namespace bayesian_icp::evaluate {

namespace {

/** Nodes of the midpoint rule over the quantiles of a chi-square variable. */
constexpr int num_nodes = 64;

double
quantileOf(int degrees_of_freedom, int node)
{
  return boost::math::quantile(boost::math::chi_squared(degrees_of_freedom),
                               (node + 0.5) / num_nodes);
}

/** Of \p distance or less; \p degrees_of_freedom may be 0. */
double
chiSquaredProbability(int degrees_of_freedom, double distance)
{
  if (degrees_of_freedom == 0)
    return distance >= 0.0 ? 1.0 : 0.0;
  return boost::math::cdf(boost::math::chi_squared(degrees_of_freedom),
                          std::max(0.0, distance));
}

/** P(w X + Y < distance), X and Y chi-square with k and 6 - k degrees of freedom. */
double
probabilityAtScale(double w, int k, double distance)
{
  if (k == 6)
    return chiSquaredProbability(6, distance / w);
  double sum = 0.0;
  for (int node = 0; node < num_nodes; ++node)
    sum += chiSquaredProbability(k, (distance - quantileOf(6 - k, node)) / w);
  return sum / num_nodes;
}

} // namespace

double
regionOf(double nees, const RegionShape& shape)
{
  if (!std::isfinite(nees))
    return nees;
  const int nu = shape.degrees_of_freedom;
  if (nu == 0 || shape.num_held == 0)
    return chiSquaredProbability(6, nees);
  double sum = 0.0;
  for (int node = 0; node < num_nodes; ++node)
    sum += probabilityAtScale((nu - 2) / quantileOf(nu, node), shape.num_held, nees);
  return sum / num_nodes;
}

} // namespace bayesian_icp::evaluate
