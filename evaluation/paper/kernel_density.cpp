#include "paper/kernel_density.h"

#include <bayesian_icp/diagnostics.h>

#include <algorithm>
#include <cmath>

namespace bayesian_icp::evaluate {

namespace {

constexpr Eigen::Index num_places = 200;
constexpr double reach = 3.0;

double
bandwidthOf(const Eigen::VectorXd& values)
{
  const auto size = static_cast<double>(values.size());
  const double variance =
      (values.array() - values.mean()).square().sum() / (size - 1.0);
  const double range = quantile(values, 0.75) - quantile(values, 0.25);
  double scale = std::sqrt(variance);
  if (range > 0.0)
    scale = std::min(scale, range / 1.34);
  return 0.9 * scale * std::pow(size, -0.2);
}

} // namespace

DensityCurve
densityOf(const Eigen::VectorXd& values)
{
  DensityCurve curve;
  const double width = bandwidthOf(values);
  const double least = quantile(values, 0.005) - reach * width;
  const double most = quantile(values, 0.995) + reach * width;
  if (!(most > least)) {
    curve.places.setConstant(3, values[0]);
    curve.heights = Eigen::Vector3d(0.0, 1.0, 0.0);
    return curve;
  }
  curve.places.setLinSpaced(num_places, least, most);
  curve.heights.resize(num_places);
  for (Eigen::Index i = 0; i < num_places; ++i)
    curve.heights[i] =
        (-0.5 * ((values.array() - curve.places[i]) / width).square()).exp().sum();
  curve.heights /= curve.heights.maxCoeff();
  return curve;
}

} // namespace bayesian_icp::evaluate
