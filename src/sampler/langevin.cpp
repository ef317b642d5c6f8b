#include "sampler/langevin.h"

#include "algebra/decompositions.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp {

namespace {

/** b = gain / (1 + noise) keeps a noisy direction stable. */
constexpr double step_gain = 1.5;
/** Variance of the gradient's noise, posterior sd = 1, at which the step size has just
 * reached its maximum: more terms per step would not help. */
constexpr double noise_target = 1.0;
constexpr double min_batch = 24.0;
/** From this share of all terms on, the exact gradient is cheaper than its noise. */
constexpr double full_batch_share = 0.7;
constexpr double max_noise_share = 0.9;
/** Long steps widen a rough density: they shrink with its mean nonlinearity, down to
 * this share of the maximum. */
constexpr double roughness_gain = 2.0;
constexpr double min_rough_share = 0.45;
/** Longest drift of a step in posterior standard deviations. */
constexpr double max_drift = 5.0;

std::size_t
automaticBatchSize(double term_noise, std::size_t num_terms)
{
  const double n = static_cast<double>(num_terms);
  const double size =
      std::max(min_batch, std::ceil(term_noise / (noise_target + term_noise / n)));
  return size >= full_batch_share * n ? num_terms : static_cast<std::size_t>(size);
}

Eigen::SelfAdjointEigenSolver<Matrix6d>
noiseOf(const GaussianFit& fit)
{
  const Matrix6d& L = fit.gaussian.factor();
  return Eigen::SelfAdjointEigenSolver<Matrix6d>(
      Matrix6d(L.transpose() * fit.term_covariance * L));
}

} // namespace

Vector6d
termNoise(const GaussianFit& fit)
{
  return noiseOf(fit).eigenvalues().cwiseMax(0.0);
}

StepPlan
planSteps(const GaussianFit& fit,
          std::size_t num_terms,
          std::size_t batch_size,
          double max_step_size)
{
  const Matrix6d& L = fit.gaussian.factor();
  const auto noise = noiseOf(fit);
  const Vector6d term_noise = noise.eigenvalues().cwiseMax(0.0);
  StepPlan plan;
  plan.directions = L * noise.eigenvectors();
  plan.batch_size = batch_size > 0 ? std::min(batch_size, num_terms)
                                   : automaticBatchSize(term_noise[5], num_terms);
  const Vector6d w = term_noise * (1.0 / static_cast<double>(plan.batch_size) -
                                   1.0 / static_cast<double>(num_terms));
  const Vector6d nonlinear =
      (plan.directions.transpose() * fit.nonlinearity * plan.directions)
          .diagonal()
          .cwiseMax(0.0);
  const double longest =
      max_step_size *
      std::max(min_rough_share, 1.0 / (1.0 + roughness_gain * nonlinear.mean()));
  for (int k = 0; k < 6; ++k) {
    const double b = std::min(longest, step_gain / (1.0 + w[k] + nonlinear[k]));
    plan.step_sizes[k] = b;
    plan.noise_shares[k] = std::min(max_noise_share, b * w[k] / (2.0 - b));
  }
  const double slowest = plan.step_sizes.minCoeff();
  plan.num_burn_in = static_cast<int>(std::clamp(4.0 / slowest, 10.0, 1000.0));
  plan.thinning = static_cast<int>(std::clamp(std::round(2.0 / slowest), 1.0, 100.0));
  return plan;
}

LangevinChain::LangevinChain(const StepPlan& plan,
                             const Vector6d& start,
                             StochasticGradient& gradient,
                             Random& random)
: SamplingChain(start)
, plan_(plan)
, noise_amplitudes_(
      (2.0 * plan.step_sizes.array() * (1.0 - plan.noise_shares.array())).sqrt())
, gradient_(gradient)
, random_(random)
, last_noise_(random.normal6())
{}

void
LangevinChain::step()
{
  const SplitGradient g = gradient_.gradient(position_, plan_.batch_size, random_);
  Vector6d drift = plan_.step_sizes.cwiseProduct(plan_.directions.transpose() *
                                                 (g.likelihood + g.prior));
  drift *= std::min(1.0, max_drift / std::max(drift.norm(), 1e-12));
  const Vector6d noise = random_.normal6();
  const Vector6d kick = 0.5 * noise_amplitudes_.cwiseProduct(noise + last_noise_);
  position_ += plan_.directions * (kick - drift);
  last_noise_ = noise;
}

} // namespace bayesian_icp
