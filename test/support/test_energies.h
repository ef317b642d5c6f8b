// Densities in six dimensions whose moments are known, as the sampler sees them.
#pragma once

#include "exact/preconditioned_sampler.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace bayesian_icp::test {

/** A density given by its likelihood's energy and gradient, a Gaussian prior about 0,
 * and artificial noise of the gradient. */
class TestEnergy : public StochasticEnergy {
public:
  std::function<double(const Vector6d&)> likelihood;
  std::function<Vector6d(const Vector6d&)> likelihood_gradient;
  Matrix6d curvature = Matrix6d::Identity();
  Vector6d prior_precision = Vector6d::Constant(1e-2);
  /** Root of the covariance of a term's gradient; zero for exact gradients. */
  Matrix6d term_noise = Matrix6d::Zero();
  std::size_t num_terms = 1;
  double start_spread = 3.0;

  std::size_t
  numTerms() const override
  {
    return num_terms;
  }

  SplitGradient
  gradient(const Vector6d& x, std::size_t batch_size, Random& random) override
  {
    const double share =
        1.0 / static_cast<double>(batch_size) - 1.0 / static_cast<double>(num_terms);
    return {likelihood_gradient(x) + std::sqrt(share) * (term_noise * random.normal6()),
            prior_precision.cwiseProduct(x)};
  }

  Matrix6d
  termCovariance(const Vector6d& /* x */, Random& /* random */) override
  {
    return term_noise * term_noise.transpose();
  }

  Matrix6d
  roughCurvature(const Vector6d& /* x */) override
  {
    return curvature;
  }

  Matrix6d
  priorPrecision() const override
  {
    return prior_precision.asDiagonal();
  }

  double
  energy(const Vector6d& x) override
  {
    return likelihood(x) + 0.5 * x.dot(prior_precision.cwiseProduct(x));
  }

  double
  fullEnergy(const Vector6d& x) override
  {
    return energy(x);
  }

  Vector6d
  toPose(const Vector6d& x) const override
  {
    return x;
  }

  Vector6d
  drawStart(Random& random) override
  {
    return start_spread * random.normal6();
  }

  /** Newton steps. */
  Vector6d
  burnIn(const Vector6d& start, Random& random) override
  {
    Vector6d x = start;
    const std::size_t batch_size = std::min<std::size_t>(160, num_terms);
    for (int step = 0; step < 20; ++step) {
      const SplitGradient g = gradient(x, batch_size, random);
      x -= (curvature + priorPrecision()).ldlt().solve(g.likelihood + g.prior);
    }
    return x;
  }

  double
  initialTemperature(const Vector6d& /* x */, const Matrix6d& /* covariance */) override
  {
    return 1.0;
  }
};

/** Angles of poses are wrapped: densities are kept well within +-pi there. */
inline ChainSet
sample(const TestEnergy& energy,
       const ExactOptions& options,
       const ChainOptions& chains,
       const ProgressCallback& progress = ProgressCallback())
{
  std::vector<std::unique_ptr<StochasticEnergy>> energies;
  for (int i = 0; i < chains.num_chains; ++i)
    energies.push_back(std::make_unique<TestEnergy>(energy));
  return runPreconditionedChains(std::move(energies), options, chains, progress);
}

/** N(mean, precision^-1) and a flat prior; the warm-up is told a wrong curvature. */
inline TestEnergy
gaussianEnergy(const Vector6d& mean, const Matrix6d& precision)
{
  TestEnergy energy;
  energy.likelihood = [=](const Vector6d& x) {
    return 0.5 * (x - mean).dot(precision * (x - mean));
  };
  energy.likelihood_gradient = [=](const Vector6d& x) -> Vector6d {
    return precision * (x - mean);
  };
  energy.curvature = 3.0 * precision;
  energy.prior_precision.setConstant(1e-6);
  energy.start_spread = 0.5;
  return energy;
}

/** Coordinate 1 is bent by coordinate 0: x1 ~ N(bend (x0^2 - s^2), 0.05^2). */
inline TestEnergy
banana(double bend)
{
  constexpr double s = 0.3, narrow = 0.05;
  TestEnergy energy;
  energy.likelihood = [=](const Vector6d& x) {
    const double y = x[1] - bend * (x[0] * x[0] - s * s);
    return 0.5 * (x[0] * x[0] / (s * s) + y * y / (narrow * narrow) +
                  x.tail<4>().squaredNorm() / (s * s));
  };
  energy.likelihood_gradient = [=](const Vector6d& x) {
    const double y = x[1] - bend * (x[0] * x[0] - s * s);
    Vector6d g = x / (s * s);
    g[1] = y / (narrow * narrow);
    g[0] -= 2.0 * bend * x[0] * g[1];
    return g;
  };
  energy.prior_precision.setConstant(1e-6);
  energy.curvature = Matrix6d::Identity() / (s * s);
  energy.curvature(0, 0) += std::pow(2.0 * bend * s / narrow, 2);
  energy.curvature(1, 1) = 1.0 / (narrow * narrow);
  energy.start_spread = 0.3;
  return energy;
}

/** Gaussians of standard deviation 0.05 at x0 = -+1, of which the second one has the
 * density lowered by \p loss nats. */
inline TestEnergy
mixture(double loss)
{
  constexpr double s = 0.05;
  const auto energies = [=](const Vector6d& x) {
    const Vector6d d = x - Vector6d::Unit(0), e = x + Vector6d::Unit(0);
    return std::array<double, 2>{0.5 * d.squaredNorm() / (s * s),
                                 0.5 * e.squaredNorm() / (s * s) + loss};
  };
  TestEnergy energy;
  energy.likelihood = [=](const Vector6d& x) {
    const auto u = energies(x);
    const double least = std::min(u[0], u[1]);
    return least - std::log(std::exp(least - u[0]) + std::exp(least - u[1]));
  };
  energy.likelihood_gradient = [=](const Vector6d& x) -> Vector6d {
    const auto u = energies(x);
    const double second = 1.0 / (1.0 + std::exp(u[1] - u[0]));
    return (x - (1.0 - 2.0 * second) * Vector6d::Unit(0)) / (s * s);
  };
  energy.curvature = Matrix6d::Identity() / (s * s);
  energy.prior_precision.setConstant(1e-6);
  energy.start_spread = 1.0;
  return energy;
}

inline ChainOptions
chainOptions(int num_draws, int num_chains = 4)
{
  ChainOptions options;
  options.num_draws = num_draws;
  options.num_chains = num_chains;
  options.seed = 7;
  return options;
}

} // namespace bayesian_icp::test
