#include <bayesian_icp/stochastic_energy.h>

namespace bayesian_icp {

StochasticEnergy::~StochasticEnergy() = default;

Vector6d
StochasticEnergy::burnIn(const Vector6d& start, Random& /* random */)
{
  return start;
}

double
StochasticEnergy::initialTemperature(const Vector6d& /* x */,
                                     const Matrix6d& /* covariance */,
                                     Random& /* random */)
{
  return 1.0;
}

bool
StochasticEnergy::hasDiverged(const Vector6d& x) const
{
  return !x.allFinite();
}

} // namespace bayesian_icp
