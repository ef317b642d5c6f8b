#include "sampler/metropolis.h"

#include <cmath>
#include <utility>

namespace bayesian_icp {

namespace {

constexpr double short_walk = 0.3;

} // namespace

MetropolisChain::MetropolisChain(const Vector6d& start,
                                 StochasticEnergy& energy,
                                 Random& random)
: SamplingChain(start)
, energy_(energy)
, random_(random)
, position_energy_(energy.fullEnergy(start))
{}

void
MetropolisChain::setProposal(std::shared_ptr<const MetropolisProposal> proposal)
{
  proposal_ = std::move(proposal);
  walks_ = jumps_ = Count();
}

bool
MetropolisChain::acceptWith(const Vector6d& proposal,
                            double log_proposal_ratio,
                            double temperature)
{
  const double energy = energy_.fullEnergy(proposal);
  const double gain = (position_energy_ - energy) / temperature;
  const bool is_accepted =
      std::log(1.0 - random_.uniform()) < gain + log_proposal_ratio;
  if (is_accepted) {
    position_ = proposal;
    position_energy_ = energy;
  }
  return is_accepted;
}

bool
MetropolisChain::walk(const Matrix6d& factor, double temperature)
{
  const double length = random_.uniform() < 0.5 ? 1.0 : short_walk;
  return acceptWith(
      position_ + length * (factor * random_.normal6()), 0.0, temperature);
}

bool
MetropolisChain::jump()
{
  const TMixture& mixture = proposal_->jumps;
  const Vector6d proposal = mixture.draw(random_);
  return acceptWith(
      proposal, mixture.logDensity(position_) - mixture.logDensity(proposal), 1.0);
}

void
MetropolisChain::step()
{
  if (is_jump_next_)
    jumps_.add(jump());
  else
    walks_.add(walk(proposal_->walk_factor, 1.0));
  is_jump_next_ = !is_jump_next_;
}

} // namespace bayesian_icp
