#include "exact/modes.h"

#include "algebra/decompositions.h"
#include "summary/estimates.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bayesian_icp {

namespace {

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

} // namespace

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

} // namespace bayesian_icp
