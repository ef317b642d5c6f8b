#include "algebra/decompositions.h"
#include "exact/preconditioned_run.h"
#include "summary/estimates.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp {

namespace {

/** Modes that are worse than the best by more than this are dropped [nats]. */
constexpr double max_evidence_loss = 10.0;
constexpr int num_evidence_draws = 16;
/** Largest squared distance of the means of one mode, in the sum of the covariances.
 */
constexpr double max_squared_distance = 25.0;
constexpr double max_squared_distance_of_draws = 9.0;
/** Energy above both ends that is no barrier [nats], and points where it is sought. */
constexpr double max_barrier = 3.0;
constexpr int num_barrier_points = 9;

bool
overlap(const Gaussian& a, const Gaussian& b)
{
  const Vector6d difference = a.mean() - b.mean();
  const Matrix6d covariance = a.covariance() + b.covariance();
  return difference.dot(covariance.ldlt().solve(difference)) <= max_squared_distance;
}

bool
hasBarrier(const Vector6d& from, const Vector6d& to, StochasticEnergy& energy)
{
  const double limit = std::max(energy.energy(from), energy.energy(to)) + max_barrier;
  for (int i = 1; i <= num_barrier_points; ++i)
    // Not finite is a barrier, too.
    if (!(energy.energy(from + (to - from) * i / (num_barrier_points + 1.0)) <= limit))
      return true;
  return false;
}

bool
drawsOverlap(const PoseMatrix& a, const PoseMatrix& b)
{
  if (a.rows() < 8 || b.rows() < 8)
    return false;
  const auto convention = CovarianceConvention::Parameters;
  const Vector6d mean_a = meanPose(a), mean_b = meanPose(b);
  const Vector6d difference = poseError(mean_a, mean_b, convention);
  const Matrix6d covariance =
      covarianceAbout(mean_a, a, convention) + covarianceAbout(mean_b, b, convention);
  return difference.dot(covariance.ldlt().solve(difference)) <=
         max_squared_distance_of_draws;
}

void
mergeInto(ChainMode& mode, const ChainMode& other)
{
  mode.members.insert(mode.members.end(), other.members.begin(), other.members.end());
  std::sort(mode.members.begin(), mode.members.end());
  mode.log_evidence = std::max(mode.log_evidence, other.log_evidence);
}

/** log of the mean of exp(values). */
double
logMeanExp(const std::vector<double>& values)
{
  const double largest = *std::max_element(values.begin(), values.end());
  double sum = 0.0;
  for (const double value : values)
    sum += std::exp(value - largest);
  return largest + std::log(sum / static_cast<double>(values.size()));
}

/** log of the integral of exp(-U) around \p gaussian, by importance sampling from it;
 * the lowest double if it is not finite. */
double
logEvidence(StochasticEnergy& energy, const Gaussian& gaussian, Random& random)
{
  std::vector<double> log_ratios;
  for (int i = 0; i < num_evidence_draws; ++i) {
    const Vector6d x = gaussian.draw(random);
    log_ratios.push_back(gaussian.energy(x) - energy.energy(x));
  }
  const double log_evidence = logMeanExp(log_ratios);
  return std::isfinite(log_evidence) ? log_evidence
                                     : std::numeric_limits<double>::lowest();
}

/** Groups chains whose Gaussians overlap, or between which there is no energy barrier.
 * \param[in] energy of any chain: all have the same values */
std::vector<ChainMode>
groupByMode(const std::vector<GaussianFit>& fits, StochasticEnergy& energy)
{
  std::vector<ChainMode> modes;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const auto isSame = [&](const ChainMode& mode) {
      const Gaussian& other =
          fits[static_cast<std::size_t>(mode.members.front())].gaussian;
      return overlap(other, fits[i].gaussian) ||
             !hasBarrier(other.mean(), fits[i].gaussian.mean(), energy);
    };
    auto found = std::find_if(modes.begin(), modes.end(), isSame);
    if (found == modes.end())
      found = modes.insert(found, ChainMode());
    found->members.push_back(static_cast<int>(i));
  }
  return modes;
}

/** Sets the evidence of the modes to the mean of their chains', and puts the best mode
 * first.
 * \param[in] log_evidences one per chain */
void
sortByEvidence(const std::vector<double>& log_evidences, std::vector<ChainMode>& modes)
{
  for (auto& mode : modes) {
    std::vector<double> of_members;
    for (const int member : mode.members)
      of_members.push_back(log_evidences[static_cast<std::size_t>(member)]);
    mode.log_evidence = logMeanExp(of_members);
  }
  std::stable_sort(
      modes.begin(), modes.end(), [](const ChainMode& a, const ChainMode& b) {
        return a.log_evidence > b.log_evidence;
      });
}

/** Moves the chains of clearly worse modes to the first one.
 * \param[in,out] set its modes are in order, the best one first */
void
moveFromWorseModes(ChainSet& set)
{
  auto& modes = set.modes;
  const double best = modes.front().log_evidence;
  while (modes.back().log_evidence < best - max_evidence_loss) {
    set.num_moved_chains += static_cast<int>(modes.back().members.size());
    set.moved_by_nats = best - modes.back().log_evidence;
    mergeInto(modes.front(), modes.back());
    modes.pop_back();
  }
}

/** Pairs of gradients of all chains of a mode in one joint iteration. */
constexpr int num_joint_pairs = 40;
constexpr int min_joint_iterations = 2;
constexpr int max_joint_iterations = 8;

/** One Gaussian a chain. */
std::vector<GaussianFit>
fitAlone(PreconditionedRun& run)
{
  std::vector<GaussianFit> fits(run.chains.size());
  run.forEachChain([&](std::size_t i) {
    auto& chain = run.chains[i];
    const Vector6d start =
        chain.energy->burnIn(chain.energy->drawStart(chain.random), chain.random);
    fits[i] = fitTempered(*chain.energy, start, chain.random, [&] {
      run.state.reportWarmUp(static_cast<int>(i));
      return !run.state.stopped();
    });
  });
  return fits;
}

/** The mean of the members' Gaussians. */
GaussianFit
pooled(const ChainMode& mode, const std::vector<Gaussian>& gaussians)
{
  Vector6d mean = Vector6d::Zero();
  Matrix6d precision = Matrix6d::Zero();
  const double share = 1.0 / static_cast<double>(mode.members.size());
  for (const int member : mode.members) {
    const auto& gaussian = gaussians[static_cast<std::size_t>(member)];
    mean += share * gaussian.mean();
    precision += share * gaussian.precision();
  }
  GaussianFit fit;
  fit.gaussian = Gaussian(mean, precision);
  return fit;
}

/** Groups the chains by mode, and leaves the modes that are clearly worse. */
void
tellModesApart(const std::vector<GaussianFit>& fits, PreconditionedRun& run)
{
  std::vector<Gaussian> gaussians;
  for (const auto& fit : fits)
    gaussians.push_back(fit.gaussian);
  run.result.modes = groupByMode(fits, *run.chains.front().energy);
  measureEvidence(gaussians, run);
  for (const auto& mode : run.result.modes)
    run.fits.push_back(pooled(mode, gaussians));
  std::vector<std::size_t> homes;
  for (std::size_t i = 0; i < run.chains.size(); ++i)
    homes.push_back(run.modeOf(i));
  moveFromWorseModes(run.result);
  run.fits.resize(run.result.modes.size());
  for (std::size_t i = 0; i < homes.size(); ++i)
    run.chains[i].start =
        homes[i] < run.fits.size() ? gaussians[i] : run.fits.front().gaussian;
}

/** Returns whether another iteration is needed. */
bool
refineOnce(int iteration, PreconditionedRun& run)
{
  std::vector<RegressionSums> sums(run.chains.size());
  run.forEachChain([&](std::size_t i) {
    const std::size_t mode = run.modeOf(i);
    const int members = static_cast<int>(run.result.modes[mode].members.size());
    sums[i] = collectGradients(*run.chains[i].energy,
                               run.fits[mode],
                               (num_joint_pairs + members - 1) / members,
                               run.chains[i].random);
    run.state.reportWarmUp(static_cast<int>(i));
  });
  bool is_done = iteration >= min_joint_iterations;
  for (std::size_t mode = 0; mode < run.fits.size(); ++mode) {
    RegressionSums total;
    for (const int member : run.result.modes[mode].members)
      total += sums[static_cast<std::size_t>(member)];
    updateFit(total,
              iteration <= min_joint_iterations ? 1.0 : 0.6,
              run.chains.front().energy->priorPrecision(),
              run.fits[mode]);
    is_done = is_done && run.fits[mode].has_converged;
  }
  return !is_done;
}

} // namespace

std::size_t
PreconditionedRun::modeOf(std::size_t i) const
{
  for (std::size_t mode = 0; mode < result.modes.size(); ++mode)
    for (const int member : result.modes[mode].members)
      if (member == static_cast<int>(i))
        return mode;
  return 0;
}

void
measureEvidence(const std::vector<Gaussian>& gaussians, PreconditionedRun& run)
{
  if (run.result.modes.size() < 2)
    return;
  std::vector<double> log_evidences(run.chains.size());
  run.forEachChain([&](std::size_t i) {
    log_evidences[i] =
        logEvidence(*run.chains[i].energy, gaussians[i], run.chains[i].random);
  });
  sortByEvidence(log_evidences, run.result.modes);
}

void
mergeOverlappingModes(ChainSet& set)
{
  auto& modes = set.modes;
  for (std::size_t i = 0; i < modes.size(); ++i)
    for (std::size_t j = i + 1; j < modes.size();) {
      if (!drawsOverlap(drawsOf(modes[i], set.chains), drawsOf(modes[j], set.chains))) {
        ++j;
        continue;
      }
      mergeInto(modes[i], modes[j]);
      modes.erase(modes.begin() + static_cast<std::ptrdiff_t>(j));
      j = i + 1;
    }
}

void
warmUp(PreconditionedRun& run)
{
  const std::vector<GaussianFit> fits = fitAlone(run);
  if (run.state.stopped())
    return;
  tellModesApart(fits, run);
  for (int i = 1; i <= max_joint_iterations; ++i)
    if (!refineOnce(i, run) || run.state.stopped())
      return;
}

} // namespace bayesian_icp
