// Metropolis chains: from the fits of the warm-up to a frozen proposal.
#include "exact/preconditioned_run.h"
#include "sampler/metropolis.h"

#include <bayesian_icp/summary.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace bayesian_icp {

namespace {

using MetropolisChains = std::vector<MetropolisChain*>;

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

/** The Gaussians of all starts in equal shares. */
TMixture
mixtureOfStarts(const std::vector<PreconditionedChain>& chains)
{
  TMixture mixture;
  double weight = 1.0;
  for (const auto& chain : chains) {
    mixture.add(chain.start.mean(), chain.start.covariance(), weight);
    weight = 1.0 / (1.0 + 1.0 / weight);
  }
  return mixture;
}

/** Whether there are draws of more than a plane. */
bool
canBeFitted(const PoseMatrix& draws)
{
  return draws.rows() > 6 && draws.allFinite() &&
         Eigen::LLT<Matrix6d>(covarianceOf(draws)).info() == Eigen::Success;
}

std::shared_ptr<const MetropolisProposal>
firstProposal(const PreconditionedRun& run)
{
  auto proposal = std::make_shared<MetropolisProposal>();
  proposal->jumps = mixtureOfStarts(run.chains);
  const Eigen::LLT<Matrix6d> llt(proposal->jumps.covarianceWithin());
  proposal->walk_factor = walk_length * Matrix6d(llt.matrixL());
  return proposal;
}

std::shared_ptr<const MetropolisProposal>
learnProposal(const PoseMatrix& draws,
              double walk_scale,
              const std::vector<GaussianFit>& fits,
              Random& random)
{
  auto proposal = std::make_shared<MetropolisProposal>();
  proposal->jumps = TMixture(draws, num_components, random);
  const Eigen::LLT<Matrix6d> llt(proposal->jumps.covarianceWithin());
  proposal->walk_factor = walk_scale * Matrix6d(llt.matrixL());
  proposal->jumps.add(draws.colwise().mean().transpose(),
                      wide_variance * covarianceOf(draws),
                      wide_share);
  const double share = warm_up_share / static_cast<double>(fits.size());
  for (const auto& fit : fits)
    proposal->jumps.add(fit.gaussian.mean(), fit.gaussian.covariance(), share);
  return proposal;
}

/** Positions after every other step of the second part of a round, in the order of the
 * chains. */
PoseMatrix
walkAndJump(int num_steps, PreconditionedRun& run)
{
  Schedule round;
  round.num_burn_in = num_steps / 8;
  round.thinning = 2;
  round.num_draws = (num_steps - round.num_burn_in) / round.thinning;
  std::vector<Chain> positions(run.chains.size());
  run.forEachChain([&](std::size_t i) {
    Path path;
    run.advance(i, round, path);
    positions[i].draws = path.positions.transpose();
  });
  return pooledDraws(positions);
}

/** The chains learn from each other in rounds, put together in their order: the draws
 * do not depend on the threads. Returns the least acceptance of jumps in the last
 * round. */
double
learnTogether(const MetropolisChains& chains, PreconditionedRun& run)
{
  Random random(run.chain_options.seed, chains.size());
  double walk_scale = walk_length, least = 1.0;
  auto proposal = firstProposal(run);
  for (const int num_steps : round_lengths) {
    for (const auto chain : chains)
      chain->setProposal(proposal);
    const PoseMatrix draws = walkAndJump(num_steps, run);
    if (run.state.stopped())
      return 1.0;
    double walks = 0.0;
    least = 1.0;
    for (const auto chain : chains) {
      walks += chain->walkAcceptance() / static_cast<double>(chains.size());
      least = std::min(least, chain->jumpAcceptance());
    }
    walk_scale = adjustedScale(walk_scale, walks);
    if (canBeFitted(draws))
      proposal = learnProposal(draws, walk_scale, run.fits, random);
  }
  for (const auto chain : chains)
    chain->setProposal(proposal);
  return least;
}

} // namespace

int
startMetropolis(PreconditionedRun& run)
{
  MetropolisChains chains(run.chains.size());
  run.forEachChain([&](std::size_t i) {
    auto& chain = run.chains[i];
    auto sampler = std::make_unique<MetropolisChain>(
        chain.start.draw(chain.random), *chain.energy, chain.random);
    if (!run.state.stopped())
      walkWhileCooling(chain.start, *sampler);
    run.state.reportWarmUp(static_cast<int>(i));
    chains[i] = sampler.get();
    chain.sampler = std::move(sampler);
  });
  if (run.state.stopped())
    return 1;
  return static_cast<int>(std::clamp(
      std::ceil(jump_thinning / learnTogether(chains, run)), 1.0, max_thinning));
}

} // namespace bayesian_icp
