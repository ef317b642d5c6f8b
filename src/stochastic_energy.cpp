#include <bayesian_icp/stochastic_energy.h>

#include <Eigen/Cholesky>

#include <algorithm>

namespace bayesian_icp {

namespace {

constexpr int num_newton_steps = 20;
constexpr std::size_t newton_batch_size = 160;

} // namespace

StochasticGradient::~StochasticGradient() = default;

StochasticEnergy::~StochasticEnergy() = default;

double
StochasticEnergy::fullEnergy(const Vector6d& x)
{
  return energy(x);
}

Vector6d
StochasticEnergy::burnIn(const Vector6d& start, Random& random)
{
  Vector6d x = start;
  const std::size_t batch_size = std::min(newton_batch_size, numTerms());
  for (int step = 0; step < num_newton_steps; ++step) {
    const Matrix6d curvature = roughCurvature(x, random) + priorPrecision();
    const SplitGradient g = gradient(x, batch_size, random);
    x -= curvature.ldlt().solve(g.likelihood + g.prior);
  }
  return x;
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
