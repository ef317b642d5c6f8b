// Metropolis chains: from the fits of the warm-up to a frozen proposal.
#include "preconditioned_run.h"

#include <bayesian_icp/metropolis.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace bayesian_icp {

namespace {

/** From this temperature down to 1 the chains walk alone, away from where their
 * warm-ups ended: in a rough density these are parts of a mode. */
constexpr double first_temperature = 16.0;
constexpr int num_steps_per_temperature = 40;
/** Steps of a chain in each round of learning. */
constexpr std::array<int, 3> round_lengths = {400, 600, 800};
constexpr int num_components = 12;
/** Share of the warm-up's Gaussians in the jumps: a mode of little weight leaves few
 * draws to fit to. */
constexpr double warm_up_share = 0.05;
/** Share and variance, in those of the draws, of a component that covers all draws: a
 * chain that found what none of the others covers would stay there for long. */
constexpr double wide_share = 0.1, wide_variance = 2.0;
/** Random walk: the best length for a Gaussian, and the acceptance of walks of mixed
 * lengths that it is adjusted to. */
const double walk_length = 2.38 / std::sqrt(6.0);
constexpr double walk_acceptance = 0.35;
/** The thinning for acceptance 1, and the largest one. */
constexpr double jump_thinning = 1.6, max_thinning = 10.0;

double
adjustedScale(double scale, double acceptance)
{
  return scale * std::exp(2.0 * (acceptance - walk_acceptance));
}

Matrix6d
covarianceOf(const Gaussian& gaussian)
{
  return gaussian.factor() * gaussian.factor().transpose();
}

void
walkWhileCooling(const Gaussian& gaussian, MetropolisChain& chain)
{
  double scale = walk_length;
  for (double temperature = first_temperature; temperature > 1.0; temperature /= 2.0) {
    int num_accepted = 0;
    const Matrix6d factor = scale * std::sqrt(temperature) * gaussian.factor();
    for (int step = 0; step < num_steps_per_temperature; ++step)
      num_accepted += chain.walk(factor, temperature) ? 1 : 0;
    scale = adjustedScale(
        scale, static_cast<double>(num_accepted) / num_steps_per_temperature);
  }
}

/** All Gaussians in equal shares. */
TMixture
mixtureOf(const std::vector<Gaussian>& gaussians)
{
  TMixture mixture;
  double weight = 1.0;
  for (const auto& gaussian : gaussians) {
    mixture.add(gaussian.mean(), covarianceOf(gaussian), weight);
    weight = 1.0 / (1.0 + 1.0 / weight);
  }
  return mixture;
}

Matrix6d
covarianceOf(const PoseMatrix& draws)
{
  const PoseMatrix centred = draws.rowwise() - draws.colwise().mean();
  return centred.transpose() * centred / static_cast<double>(draws.rows() - 1);
}

/** Whether there are draws of more than a plane. */
bool
canBeFitted(const PoseMatrix& draws)
{
  return draws.allFinite() &&
         Eigen::LLT<Matrix6d>(covarianceOf(draws)).info() == Eigen::Success;
}

} // namespace

std::shared_ptr<const MetropolisProposal>
PreconditionedRun::firstProposal() const
{
  auto proposal = std::make_shared<MetropolisProposal>();
  proposal->jumps = mixtureOf(starts_);
  const Eigen::LLT<Matrix6d> llt(proposal->jumps.covarianceWithin());
  proposal->walk_factor = walk_length * Matrix6d(llt.matrixL());
  return proposal;
}

std::shared_ptr<const MetropolisProposal>
PreconditionedRun::learnProposal(const PoseMatrix& draws,
                                 double walk_scale,
                                 Random& random) const
{
  auto proposal = std::make_shared<MetropolisProposal>();
  proposal->jumps = TMixture(draws, num_components, random);
  const Eigen::LLT<Matrix6d> llt(proposal->jumps.covarianceWithin());
  proposal->walk_factor = walk_scale * Matrix6d(llt.matrixL());
  proposal->jumps.add(draws.colwise().mean().transpose(),
                      wide_variance * covarianceOf(draws),
                      wide_share);
  const double share = warm_up_share / static_cast<double>(fits_.size());
  for (const auto& fit : fits_)
    proposal->jumps.add(fit.gaussian.mean(), covarianceOf(fit.gaussian), share);
  return proposal;
}

/** Positions after every other step of the second part of a round, in the order of the
 * chains. */
PoseMatrix
PreconditionedRun::walkAndJump(int num_steps, const MetropolisChains& chains)
{
  const int num_left_out = num_steps / 8, num_kept = (num_steps - num_left_out) / 2;
  PoseMatrix positions(num_kept * options_.num_chains, 6);
  forEach([&](std::size_t i) {
    auto row = static_cast<Eigen::Index>(i) * num_kept;
    for (int step = 0; step < num_left_out && !run_.stopped(); ++step)
      chains[i]->step();
    for (int k = 0; k < num_kept && !run_.stopped(); ++k) {
      chains[i]->step();
      chains[i]->step();
      positions.row(row++) = chains[i]->position().transpose();
      run_.reportWarmUp(static_cast<int>(i));
    }
  });
  return positions;
}

/** The chains learn from each other in rounds, put together in their order: the draws
 * do not depend on the threads. Returns the least acceptance of jumps in the last
 * round. */
double
PreconditionedRun::learnTogether(const MetropolisChains& chains)
{
  Random random(options_.seed, states_.size());
  double walk_scale = walk_length, least = 1.0;
  auto proposal = firstProposal();
  for (const int num_steps : round_lengths) {
    for (const auto chain : chains)
      chain->setProposal(proposal);
    const PoseMatrix draws = walkAndJump(num_steps, chains);
    if (run_.stopped())
      return 1.0;
    double walks = 0.0;
    least = 1.0;
    for (const auto chain : chains) {
      walks += chain->walkAcceptance() / static_cast<double>(chains.size());
      least = std::min(least, chain->jumpAcceptance());
    }
    walk_scale = adjustedScale(walk_scale, walks);
    if (canBeFitted(draws))
      proposal = learnProposal(draws, walk_scale, random);
  }
  for (const auto chain : chains)
    chain->setProposal(proposal);
  return least;
}

StepPlan
PreconditionedRun::startMetropolis()
{
  MetropolisChains chains(states_.size());
  forEach([&](std::size_t i) {
    auto& state = states_[i];
    auto chain = std::make_unique<MetropolisChain>(
        starts_[i].draw(*state.random), *state.energy, *state.random);
    if (!run_.stopped())
      walkWhileCooling(starts_[i], *chain);
    run_.reportWarmUp(static_cast<int>(i));
    chains[i] = chain.get();
    state.sampling = std::move(chain);
  });
  StepPlan common;
  if (!run_.stopped())
    common.thinning = static_cast<int>(std::clamp(
        std::ceil(jump_thinning / learnTogether(chains)), 1.0, max_thinning));
  return common;
}

} // namespace bayesian_icp
