#include "samplers/gold_run.h"
#include "study/cpu_time.h"
#include "study/draw_statistics.h"

#include <bayesian_icp/diagnostics.h>

#include <algorithm>
#include <iomanip>
#include <sstream>

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

void
leaveWorseModes(std::vector<GoldRun>& runs)
{
  double best_energy = runs[0].meanEnergies()[0];
  Vector6d best = runs[0].position(0);
  for (const GoldRun& run : runs)
    for (int chain = 0; chain < run.meanEnergies().size(); ++chain)
      if (run.meanEnergies()[chain] < best_energy) {
        best_energy = run.meanEnergies()[chain];
        best = run.position(chain);
      }
  for (GoldRun& run : runs)
    for (int chain = 0; chain < run.meanEnergies().size(); ++chain)
      if (run.meanEnergies()[chain] > best_energy + worse_mode)
        run.moveTo(chain, best);
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
  gold.acceptance = 0.5 * (runs[0].acceptance() + runs[1].acceptance());
  gold.has_converged = gold.rhat < options.max_rhat &&
                       gold.kl_between_runs <= options.max_kl &&
                       std::min(gold.bulk_ess, gold.tail_ess) >= options.min_ess;
}

std::string
describe(const GoldStandard& gold)
{
  std::ostringstream text;
  text << std::fixed << std::setprecision(4) << "R-hat " << gold.rhat
       << ", KL between runs " << gold.kl_between_runs << std::setprecision(0)
       << ", ESS bulk " << gold.bulk_ess << " tail " << gold.tail_ess
       << std::setprecision(2) << ", accepted " << gold.acceptance << ", "
       << std::setprecision(1) << gold.seconds << " s";
  return text.str();
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
  const double begin = cpuSeconds();
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
    gold.seconds = cpuSeconds() - begin;
    report(describe(gold));
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
