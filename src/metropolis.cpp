#include <bayesian_icp/metropolis.h>

#include <cmath>

namespace bayesian_icp {

namespace {

/** Degrees of freedom of the t: tails heavy enough for a density flatter than the
 * Gaussian. */
constexpr int t_degrees = 8;
/** Random walk: 2.38 / sqrt(6), the best for a Gaussian, and a third of it. */
constexpr double long_walk = 0.97, short_walk = 0.32;
constexpr int steps_of_a_round = 3;

} // namespace

SamplingChain::~SamplingChain() = default;

MetropolisChain::MetropolisChain(const Gaussian& gaussian,
                                 const Vector6d& start,
                                 StochasticEnergy& energy,
                                 Random& random)
: gaussian_(gaussian)
, energy_(energy)
, random_(random)
, position_(start)
, position_energy_(energy.energy(start))
{}

/** -log density of the t, up to a constant. */
double
MetropolisChain::proposalEnergy(const Vector6d& x) const
{
  const double squared =
      (gaussian_.inverseFactor() * (x - gaussian_.mean())).squaredNorm();
  return 0.5 * (t_degrees + 6) * std::log1p(squared / t_degrees);
}

bool
MetropolisChain::acceptWith(const Vector6d& proposal, double log_proposal_ratio)
{
  const double energy = energy_.energy(proposal);
  const bool is_accepted = std::log(1.0 - random_.uniform()) <
                           position_energy_ - energy + log_proposal_ratio;
  if (is_accepted) {
    position_ = proposal;
    position_energy_ = energy;
  }
  return is_accepted;
}

void
MetropolisChain::step()
{
  const Vector6d z = random_.normal6();
  if (++num_steps_ % steps_of_a_round == 0) {
    const double length = random_.uniform() < 0.5 ? long_walk : short_walk;
    acceptWith(position_ + length * (gaussian_.factor() * z), 0.0);
    return;
  }
  double chi_squared = 0.0;
  for (int i = 0; i < t_degrees; ++i) {
    const double normal = random_.normal();
    chi_squared += normal * normal;
  }
  const Vector6d proposal =
      gaussian_.mean() + std::sqrt(t_degrees / chi_squared) * (gaussian_.factor() * z);
  ++num_independent_;
  if (acceptWith(proposal, proposalEnergy(proposal) - proposalEnergy(position_)))
    ++num_accepted_;
}

const Vector6d&
MetropolisChain::position() const
{
  return position_;
}

double
MetropolisChain::acceptance() const
{
  return num_independent_ > 0 ? static_cast<double>(num_accepted_) /
                                    static_cast<double>(num_independent_)
                              : 0.0;
}

} // namespace bayesian_icp
