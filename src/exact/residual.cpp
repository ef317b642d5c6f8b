#include "exact/residual.h"

#include <cmath>

namespace bayesian_icp {

double
robustEnergy(const ResidualOptions& options, double squared_residual)
{
  const double k = options.kernel_width;
  const bool is_within = squared_residual <= k * k;
  switch (options.kernel) {
  case RobustKernel::None:
    break;
  case RobustKernel::Huber:
    return is_within ? 0.5 * squared_residual
                     : k * (std::sqrt(squared_residual) - 0.5 * k);
  case RobustKernel::Tukey: {
    const double rest = is_within ? 1.0 - squared_residual / (k * k) : 0.0;
    return k * k / 6.0 * (1.0 - rest * rest * rest);
  }
  }
  return 0.5 * squared_residual;
}

double
robustWeight(const ResidualOptions& options, double squared_residual)
{
  const double k = options.kernel_width;
  const bool is_within = squared_residual <= k * k;
  switch (options.kernel) {
  case RobustKernel::None:
    break;
  case RobustKernel::Huber:
    return is_within ? 1.0 : k / std::sqrt(squared_residual);
  case RobustKernel::Tukey: {
    const double rest = is_within ? 1.0 - squared_residual / (k * k) : 0.0;
    return rest * rest;
  }
  }
  return 1.0;
}

double
unmatchedEnergy(const ResidualOptions& options)
{
  if (!std::isfinite(options.max_distance))
    return 0.0;
  return robustEnergy(options, options.max_distance * options.max_distance);
}

} // namespace bayesian_icp
