#include "samplers/metropolis_runs.h"

#include <cmath>
#include <utility>

namespace bayesian_icp::evaluate {

MetropolisState::MetropolisState(const Vector6d& start,
                                 EnergyFunction energy,
                                 Random random)
: energy_(std::move(energy))
, random_(random)
, position_(start)
, current_energy_(energy_(start))
{}

bool
MetropolisState::accept(const Vector6d& proposal,
                        double log_proposal_ratio,
                        double temperature)
{
  const double energy = energy_(proposal);
  const double log_ratio =
      (current_energy_ - energy) / temperature + log_proposal_ratio;
  if (!(std::log(1.0 - random_.uniform()) < log_ratio))
    return false;
  position_ = proposal;
  current_energy_ = energy;
  return true;
}

bool
MetropolisState::walk(const Matrix6d& factor, double temperature)
{
  return accept(position_ + factor * random_.normal6(), 0.0, temperature);
}

bool
MetropolisState::jump(const TMixture& mixture)
{
  const Vector6d proposal = mixture.draw(random_);
  return accept(
      proposal, mixture.logDensity(position_) - mixture.logDensity(proposal), 1.0);
}

void
MetropolisState::moveTo(const Vector6d& position)
{
  position_ = position;
  current_energy_ = energy_(position);
}

PoseMatrix
runRandomWalk(const Vector6d& start,
              const EnergyFunction& energy,
              const Matrix6d& factor,
              int num_steps,
              Random& random)
{
  MetropolisState state(start, energy, random);
  PoseMatrix draws(num_steps, 6);
  for (int step = 0; step < num_steps; ++step) {
    state.walk(factor);
    draws.row(step) = state.position().transpose();
  }
  random = state.random();
  return draws;
}

PoseMatrix
runMala(const Vector6d& start,
        const GradientFunction& energy,
        const Matrix6d& factor,
        double step,
        int num_steps,
        Random& random)
{
  const Matrix6d preconditioner = factor * factor.transpose();
  const auto whiten = [&factor](const Vector6d& v) {
    return Vector6d(factor.triangularView<Eigen::Lower>().solve(v));
  };
  PoseMatrix draws(num_steps, 6);
  Vector6d x = start, gradient, proposed_gradient;
  double u = energy(x, gradient);
  for (int i = 0; i < num_steps; ++i) {
    const Vector6d z = random.normal6();
    const Vector6d y =
        x - 0.5 * step * preconditioner * gradient + std::sqrt(step) * factor * z;
    const double v = energy(y, proposed_gradient);
    const Vector6d back =
        whiten(x - y + 0.5 * step * preconditioner * proposed_gradient);
    const double log_ratio =
        u - v + 0.5 * z.squaredNorm() - 0.5 * back.squaredNorm() / step;
    if (std::log(1.0 - random.uniform()) < log_ratio) {
      x = y;
      u = v;
      gradient = proposed_gradient;
    }
    draws.row(i) = x.transpose();
  }
  return draws;
}

} // namespace bayesian_icp::evaluate
