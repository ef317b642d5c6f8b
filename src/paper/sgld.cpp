#include "paper/sgld.h"

#include <cmath>
#include <utility>

namespace bayesian_icp {

RmsPropPreconditioner::RmsPropPreconditioner(const SgldOptions& options)
: decay_rate_(options.decay_rate)
, lambda_rms_(options.lambda_rms)
, mean_square_gradient_(Vector6d::Zero())
{}

Vector6d
RmsPropPreconditioner::update(const Vector6d& mini_batch_mean_gradient)
{
  mean_square_gradient_ = decay_rate_ * mean_square_gradient_ + // eq. (10)
                          (1.0 - decay_rate_) * mini_batch_mean_gradient.cwiseAbs2();
  return (lambda_rms_ + mean_square_gradient_.cwiseSqrt().array())
      .inverse(); // eq. (11)
}

double
stepSizeAt(const SgldOptions& options, long step, long num_steps)
{
  const double first = options.block_decay_start * static_cast<double>(num_steps);
  if (static_cast<double>(step) < first)
    return options.step_size;
  const double blocks =
      std::floor((static_cast<double>(step) - first) / options.block_decay_interval) +
      1;
  return options.step_size * std::pow(options.block_decay_factor, blocks);
}

Vector6d
sgldStep(const Vector6d& pose,
         const Vector6d& energy_gradient,
         const Vector6d& preconditioner,
         double step_size,
         double noise_factor,
         Random& random)
{
  const Vector6d injected_noise = (noise_factor * step_size * preconditioner)
                                      .cwiseSqrt()
                                      .cwiseProduct(random.normal6());
  return pose - 0.5 * step_size * preconditioner.cwiseProduct(energy_gradient) +
         injected_noise;
}

SgldChain::SgldChain(const SgldOptions& options,
                     long num_steps,
                     const Vector6d& start,
                     MiniBatchGradient gradient,
                     RunsAway runs_away,
                     Random& random)
: SamplingChain(start)
, options_(options)
, num_steps_(num_steps)
, gradient_(std::move(gradient))
, runs_away_(std::move(runs_away))
, preconditioner_(options)
, random_(random)
{}

void
SgldChain::step()
{
  const Vector6d pose = position_;
  const EnergyGradient gradient = gradient_(pose, random_);            // (2, 3, 6, 7)
  const Vector6d A = preconditioner_.update(gradient.mini_batch_mean); // (10, 11)
  const double alpha = stepSizeAt(options_, steps_made_++, num_steps_);
  position_ = sgldStep(
      pose, gradient.energy, A, alpha, options_.noise_factor, random_); // (5, 8, 9)
  num_jumps_ += (position_ - pose).tail<3>().cwiseAbs().maxCoeff() > M_PI;
}

} // namespace bayesian_icp
