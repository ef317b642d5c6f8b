#include "samplers/gold_standard.h"

#include "io/clocks.h"
#include "study/draw_statistics.h"
#include "study/text_table.h"

#include <bayesian_icp/diagnostics.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>

namespace bayesian_icp::evaluate {

namespace {

/** A chain whose energy is further above the best one's [nats] is in a mode without
 * weight, and is moved to where the best one is. In six dimensions energies within one
 * mode differ by a few. */
constexpr double worse_mode = 20.0;
constexpr int num_adaptive_rounds = 3;
constexpr int num_components = 12;
/** Draws of a chain that are kept in the end. */
constexpr Eigen::Index max_kept_draws = 4000;

/** Energies of the starts are this many temperatures above zero when cooling begins. */
constexpr double hot_energy = 10.0;
/** Of walks of mixed lengths, see GoldRun::advanceChain(). */
constexpr double best_walk_acceptance = 0.35;
/** Optimal scale of a random walk in six dimensions (Roberts et al. 1997). */
const double walk_scale = 2.38 / std::sqrt(6.0);

/** One of the runs behind a gold standard: chains that learn a walk together. */
class GoldRun {
public:
  /** \param[in] target must outlive this object
   * \param[in] run number of the run: its random numbers */
  GoldRun(const GoldTarget& target, const GoldOptions& options, int run)
  : options_(options)
  , walk_factor_(0.3 * target.start_spread.asDiagonal())
  , draws_(static_cast<std::size_t>(options.chains_per_run), PoseMatrix(0, 6))
  {
    for (int chain = 0; chain < options.chains_per_run; ++chain) {
      Random random(options.seed, static_cast<std::uint64_t>(1000 * run + chain + 1));
      const Vector6d start = target.draw_start(random);
      chains_.emplace_back(start, target.make_energy(), random);
    }
  }

  /** Random walks while the temperature falls to 1. */
  void
  anneal()
  {
    double temperature = 1.0;
    for (const MetropolisState& chain : chains_)
      temperature = std::max(temperature, chain.energy() / hot_energy);
    const int num_steps = std::max(options_.steps_per_round / 5, 50);
    for (bool done = false; !done; temperature = std::max(1.0, 0.5 * temperature)) {
      done = temperature == 1.0;
      learnWalk(advance(done ? 5 * num_steps : num_steps, temperature));
    }
  }

  std::vector<MetropolisState>&
  chains()
  {
    return chains_;
  }

  /** One round whose draws serve to fit proposals and are then forgotten; the walk
   * learns from them here.
   * \return positions of all chains, the first part of the round left out */
  PoseMatrix
  adapt()
  {
    // Chains that were just moved have to forget where.
    advance(options_.steps_per_round / 2, 1.0);
    const auto positions = advance(options_.steps_per_round, 1.0);
    learnWalk(positions);
    return pooled(positions);
  }

  /** Jump with these proposals from now on. */
  void
  setMixture(std::shared_ptr<const TMixture> mixture)
  {
    mixture_ = std::move(mixture);
  }

  /** One round with the frozen proposals. */
  void
  sample()
  {
    const auto positions = advance(options_.steps_per_round, 1.0);
    for (std::size_t i = 0; i < draws_.size(); ++i)
      draws_[i] = pooled({draws_[i], positions[i]});
  }

  /** Draws kept by sample(), a matrix a chain. */
  const std::vector<PoseMatrix>&
  draws() const
  {
    return draws_;
  }

private:
  /** Positions after every second step of one stage. */
  std::vector<PoseMatrix>
  advance(int num_steps, double temperature)
  {
    const int num_rows = mixture_ ? num_steps / 2 : num_steps;
    std::vector<PoseMatrix> positions(chains_.size(), PoseMatrix(num_rows, 6));
    std::vector<long> num_accepted(chains_.size());
#pragma omp parallel for num_threads(options_.num_threads) schedule(static)
    for (std::size_t i = 0; i < chains_.size(); ++i)
      num_accepted[i] = advanceChain(chains_[i], temperature, positions[i]);
    num_walks_ += static_cast<long>(chains_.size()) * num_rows;
    num_accepted_ += std::accumulate(num_accepted.begin(), num_accepted.end(), 0L);
    return positions;
  }

  /** \return how many walks were accepted */
  long
  advanceChain(MetropolisState& chain, double temperature, PoseMatrix& positions) const
  {
    long num_accepted = 0;
    for (auto position : positions.rowwise()) {
      // Short walks now and then: they are accepted where the density is rough.
      const double length = chain.random().uniform() < 0.5 ? 1.0 : 0.3;
      num_accepted += chain.walk(walk_scale_ * length * walk_factor_, temperature);
      if (mixture_)
        chain.jump(*mixture_);
      position = chain.position().transpose();
    }
    return num_accepted;
  }

  void
  learnWalk(const std::vector<PoseMatrix>& positions)
  {
    const double acceptance =
        static_cast<double>(num_accepted_) / static_cast<double>(num_walks_);
    num_accepted_ = num_walks_ = 0;
    walk_scale_ *= std::exp(2.0 * (acceptance - best_walk_acceptance));
    // Within the chains: modes that are apart do not widen it.
    Matrix6d covariance = Matrix6d::Zero();
    for (const PoseMatrix& chain : positions)
      covariance += momentsOf(chain).covariance;
    const Eigen::LLT<Matrix6d> llt(covariance / static_cast<double>(positions.size()));
    // Too few moves teach no shape.
    if (acceptance < 0.1 || llt.info() != Eigen::Success)
      return;
    walk_factor_ = walk_scale * Matrix6d(llt.matrixL());
  }

  GoldOptions options_;
  std::vector<MetropolisState> chains_;
  Matrix6d walk_factor_;
  double walk_scale_ = 1.0;
  std::shared_ptr<const TMixture> mixture_;
  std::vector<PoseMatrix> draws_;
  /** Since the walk has learned. */
  long num_walks_ = 0, num_accepted_ = 0;
};

void
leaveWorseModes(std::vector<GoldRun>& runs)
{
  double best_energy = std::numeric_limits<double>::infinity();
  Vector6d best = Vector6d::Zero();
  for (GoldRun& run : runs)
    for (const MetropolisState& chain : run.chains())
      if (chain.energy() < best_energy) {
        best_energy = chain.energy();
        best = chain.position();
      }
  for (GoldRun& run : runs)
    for (MetropolisState& chain : run.chains())
      if (chain.energy() > best_energy + worse_mode)
        chain.moveTo(best);
}

/** Fit the proposals of all runs to what all of them have found. */
void
adaptTogether(const GoldOptions& options, std::vector<GoldRun>& runs)
{
  Random random(options.seed, 0);
  for (int round = 0; round < num_adaptive_rounds; ++round) {
    std::vector<PoseMatrix> positions;
    positions.reserve(runs.size());
    for (GoldRun& run : runs)
      positions.push_back(run.adapt());
    const auto mixture =
        std::make_shared<const TMixture>(pooled(positions), num_components, random);
    for (GoldRun& run : runs)
      run.setMixture(mixture);
  }
}

/** Fill in how well the runs agree. */
void
judge(const std::vector<GoldRun>& runs, const GoldOptions& options, GoldStandard& gold)
{
  gold.chains.clear();
  for (const GoldRun& run : runs)
    gold.chains.insert(gold.chains.end(), run.draws().begin(), run.draws().end());
  gold.rhat = 0.0;
  gold.bulk_ess = gold.tail_ess = 1e300;
  const auto num_chains = static_cast<Eigen::Index>(gold.chains.size());
  for (int k = 0; k < 6; ++k) {
    Eigen::MatrixXd values(gold.chains[0].rows(), num_chains);
    for (Eigen::Index i = 0; i < num_chains; ++i)
      values.col(i) = gold.chains[static_cast<std::size_t>(i)].col(k);
    gold.rhat = std::max(gold.rhat, rhat(values));
    gold.bulk_ess = std::min(gold.bulk_ess, bulkEss(values));
    gold.tail_ess = std::min(gold.tail_ess, tailEss(values));
  }
  const Moments first = momentsOf(pooled(runs[0].draws()));
  const Moments second = momentsOf(pooled(runs[1].draws()));
  gold.kl_between_runs = std::max(gaussianKl(first, second), gaussianKl(second, first));
  gold.has_converged = gold.rhat < options.max_rhat &&
                       gold.kl_between_runs <= options.max_kl &&
                       std::min(gold.bulk_ess, gold.tail_ess) >= options.min_ess;
}

/** Every k-th draw, so that at most max_kept_draws are left. */
PoseMatrix
thinned(const PoseMatrix& draws)
{
  const Eigen::Index stride = (draws.rows() + max_kept_draws - 1) / max_kept_draws;
  PoseMatrix kept(draws.rows() / stride, 6);
  for (Eigen::Index row = 0; row < kept.rows(); ++row)
    kept.row(row) = draws.row(row * stride);
  return kept;
}

} // namespace

GoldStandard
sampleGold(const GoldTarget& target,
           const GoldOptions& options,
           const std::function<void(const std::string&)>& report)
{
  const double begin = io::cpuSeconds();
  constexpr int num_runs = 2;
  std::vector<GoldRun> runs;
  runs.reserve(num_runs);
  for (int run = 0; run < num_runs; ++run)
    runs.emplace_back(target, options, run);
  for (GoldRun& run : runs)
    run.anneal();
  leaveWorseModes(runs);
  adaptTogether(options, runs);
  GoldStandard gold;
  while (!gold.has_converged && gold.seconds < options.max_seconds) {
    for (GoldRun& run : runs)
      run.sample();
    judge(runs, options, gold);
    gold.seconds = io::cpuSeconds() - begin;
    report(format("R-hat %.4f, KL between runs %.4f, ESS bulk %.0f tail %.0f, %.1f s",
                  gold.rhat,
                  gold.kl_between_runs,
                  gold.bulk_ess,
                  gold.tail_ess,
                  gold.seconds));
  }
  for (PoseMatrix& chain : gold.chains)
    chain = thinned(chain);
  return gold;
}

PoseMatrix
pooled(const std::vector<PoseMatrix>& chains)
{
  Eigen::Index num_rows = 0;
  for (const PoseMatrix& chain : chains)
    num_rows += chain.rows();
  PoseMatrix all(num_rows, 6);
  Eigen::Index row = 0;
  for (const PoseMatrix& chain : chains) {
    all.middleRows(row, chain.rows()) = chain;
    row += chain.rows();
  }
  return all;
}

} // namespace bayesian_icp::evaluate
