#include "samplers/gold_run.h"

#include "study/draw_statistics.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp::evaluate {

namespace {

/** Energies of the starts are this many temperatures above zero when cooling begins. */
constexpr double hot_energy = 10.0;
/** Of walks of mixed lengths, see advanceChain. */
constexpr double best_walk_acceptance = 0.35;
/** Optimal scale of a random walk in six dimensions (Roberts et al. 1997). */
const double walk_scale = 2.38 / std::sqrt(6.0);

/** Covariance within the chains: modes that are apart do not widen it. */
Matrix6d
covarianceWithin(const std::vector<PoseMatrix>& positions)
{
  Matrix6d sum = Matrix6d::Zero();
  for (const PoseMatrix& chain : positions)
    sum += momentsOf(chain).covariance;
  return sum / static_cast<double>(positions.size());
}

} // namespace

GoldRun::GoldRun(const GoldTarget& target, const GoldOptions& options, int run)
: options_(options)
, walk_factor_(0.3 * target.start_spread.asDiagonal())
, mean_energies_(options.chains_per_run)
, draws_(static_cast<std::size_t>(options.chains_per_run), PoseMatrix(0, 6))
{
  for (int chain = 0; chain < options.chains_per_run; ++chain) {
    Random random(options.seed, static_cast<std::uint64_t>(1000 * run + chain + 1));
    const Vector6d start = target.draw_start(random);
    chains_.emplace_back(start, target.make_energy(), random);
  }
}

GoldRun::Counts
GoldRun::advanceChain(MetropolisState& chain,
                      double temperature,
                      PoseMatrix& positions) const
{
  Counts counts;
  for (Eigen::Index row = 0; row < positions.rows(); ++row) {
    // Short walks now and then: they are accepted where the density is rough.
    const double length = chain.random().uniform() < 0.5 ? 1.0 : 0.3;
    ++counts.walks;
    counts.accepted_walks +=
        chain.walk(walk_scale_ * length * walk_factor_, temperature);
    if (mixture_) {
      ++counts.jumps;
      counts.accepted_jumps += chain.jump(*mixture_);
    }
    positions.row(row) = chain.position().transpose();
  }
  return counts;
}

std::vector<PoseMatrix>
GoldRun::advance(int num_steps, double temperature)
{
  const int num_chains = options_.chains_per_run;
  const int num_rows = mixture_ ? num_steps / 2 : num_steps;
  std::vector<PoseMatrix> positions(chains_.size(), PoseMatrix(num_rows, 6));
  std::vector<Counts> counts(chains_.size());
#pragma omp parallel for num_threads(options_.num_threads) schedule(static)
  for (int chain = 0; chain < num_chains; ++chain) {
    const auto i = static_cast<std::size_t>(chain);
    counts[i] = advanceChain(chains_[i], temperature, positions[i]);
  }
  for (const Counts& chain : counts) {
    counts_.walks += chain.walks;
    counts_.accepted_walks += chain.accepted_walks;
    counts_.jumps += chain.jumps;
    counts_.accepted_jumps += chain.accepted_jumps;
  }
  return positions;
}

void
GoldRun::learnWalk(const std::vector<PoseMatrix>& positions)
{
  const double acceptance =
      static_cast<double>(counts_.accepted_walks) / static_cast<double>(counts_.walks);
  counts_ = Counts();
  walk_scale_ *= std::exp(2.0 * (acceptance - best_walk_acceptance));
  const Eigen::LLT<Matrix6d> llt(covarianceWithin(positions));
  // Too few moves teach no shape.
  if (acceptance < 0.1 || llt.info() != Eigen::Success)
    return;
  walk_factor_ = walk_scale * Matrix6d(llt.matrixL());
}

void
GoldRun::anneal()
{
  double temperature = 1.0;
  for (const MetropolisState& chain : chains_)
    temperature = std::max(temperature, chain.energy() / hot_energy);
  const int num_steps = std::max(options_.steps_per_round / 5, 50);
  for (bool done = false; !done; temperature = std::max(1.0, 0.5 * temperature)) {
    done = temperature == 1.0;
    learnWalk(advance(done ? 5 * num_steps : num_steps, temperature));
  }
  for (int chain = 0; chain < options_.chains_per_run; ++chain)
    mean_energies_[chain] = chains_[static_cast<std::size_t>(chain)].energy();
}

PoseMatrix
GoldRun::adapt()
{
  // Chains that were just moved have to forget where.
  advance(options_.steps_per_round / 2, 1.0);
  const auto positions = advance(options_.steps_per_round, 1.0);
  learnWalk(positions);
  return pooled(positions);
}

void
GoldRun::sample()
{
  const auto positions = advance(options_.steps_per_round, 1.0);
  for (std::size_t i = 0; i < draws_.size(); ++i) {
    const Eigen::Index old_rows = draws_[i].rows();
    draws_[i].conservativeResize(old_rows + positions[i].rows(), 6);
    draws_[i].bottomRows(positions[i].rows()) = positions[i];
  }
}

double
GoldRun::acceptance() const
{
  return counts_.jumps == 0 ? 0.0
                            : static_cast<double>(counts_.accepted_jumps) /
                                  static_cast<double>(counts_.jumps);
}

} // namespace bayesian_icp::evaluate
