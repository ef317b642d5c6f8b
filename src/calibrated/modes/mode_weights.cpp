#include "calibrated/modes/mode_weights.h"

#include "algebra/decompositions.h"
#include "calibrated/draws/product_coordinates.h"
#include "geometry/twist.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::VectorXd;

namespace {

/** A difference of two modes' energies within this many standard deviations counts as
 * none. */
constexpr double unheeded_deviations = 2.0;

/** Where two views differ, the same surface fits less well, because each sees other
 * parts of it. A mean energy of the points that fit which is above the least one by
 * this factor counts as the same. Rows of pillars: 1.12. */
constexpr double tolerated_misfit = 1.15;

/** Weight of the energy: the scalar nearest to the weights of the scores. */
double
energyWeight(const CalibratedEstimate& estimate)
{
  std::vector<Index> held;
  for (int k = 0; k < 6; ++k)
    if (estimate.keep[k] > 0.0)
      held.push_back(k);
  if (held.empty())
    return 1.0 / estimate.kappa_inf;
  Eigen::MatrixXd V(6, held.size());
  for (std::size_t i = 0; i < held.size(); ++i)
    V.col(static_cast<Index>(i)) = estimate.directions.col(held[i]);
  const Eigen::MatrixXd information = V.transpose() * estimate.information * V;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> ratio(
      V.transpose() * estimate.curvature * V, information);
  double sum = 0.0;
  int count = 0;
  for (const double value : ratio.eigenvalues())
    if (value > 0.0) {
      sum += std::log(value);
      ++count;
    }
  return count > 0 ? std::exp(-sum / count) : 1.0 / estimate.kappa_inf;
}

/** Tukey's energy of each point. A point without a patch has the largest energy. If \p
 * continued, it has this energy only as far as it is off the continuation of the
 * surface, but at least the mean of the others. */
VectorXd
energiesOf(const SurfaceScores& scores, double tau, bool continued)
{
  const double scale = SurfaceScorer::tukey_constant * tau;
  const double largest = scale * scale / 6.0;
  VectorXd energies(scores.residuals.size());
  double sum = 0.0;
  int count = 0;
  for (Index i = 0; i < energies.size(); ++i)
    if (scores.has_patch[static_cast<std::size_t>(i)]) {
      energies[i] = largest * tukeyEnergy(scores.residuals[i] / scale);
      sum += energies[i];
      ++count;
    }
  const double least = continued ? sum / std::max(1, count) : largest;
  for (Index i = 0; i < energies.size(); ++i)
    if (!scores.has_patch[static_cast<std::size_t>(i)])
      energies[i] = std::max(least, largest * scores.off_continuation[i]);
  return energies;
}

/** A cloud is part of the other one if at least the second share of its points fits,
 * and surely not below the first. */
constexpr double no_part = 0.65, part = 0.85;

/** How far the points of each cloud count. A map or a CAD model has points that the
 * scan cannot meet, and a wrong mode may hide more of them. So if one cloud is part of
 * the other, the other one's points do not count if less than half as many of them fit.
 */
struct CloudFactors {
  double source, target;
};

CloudFactors
cloudFactors(const std::vector<CalibratedMode>& modes)
{
  double source = 0.0, target = 0.0;
  for (const auto& mode : modes) {
    const ActiveShares active = activeSharesOf(mode.estimate.scores);
    source = std::fmax(source, active.source);
    target = std::fmax(target, active.target);
  }
  const auto factorOf = [](double share, double other) {
    const double is_part = std::clamp((other - no_part) / (part - no_part), 0.0, 1.0);
    const double ratio = share / std::max(other, std::numeric_limits<double>::min());
    return 1.0 - is_part * (1.0 - std::clamp(2.0 * ratio - 1.0, 0.0, 1.0));
  };
  return {factorOf(source, target), factorOf(target, source)};
}

/** The part of an energy that is above its own noise. */
double
heededPart(double energy, double variance)
{
  if (!(energy > 0.0))
    return 0.0;
  constexpr double squared_deviations = unheeded_deviations * unheeded_deviations;
  return energy *
         std::max(0.0, 1.0 - squared_deviations * variance / (energy * energy));
}

/** The part of the sum of the \p differences of two modes' energies that counts.
 * Patches have \p kappa points. If \p region is not 0, points that meet the target in
 * only one mode are counted separately, and their patches have \p region points. */
double
heededEnergy(const VectorXd& differences,
             const SurfaceScores& a,
             const SurfaceScores& b,
             double kappa,
             double region)
{
  struct Sums {
    double energy = 0.0, squares = 0.0;
  } seen, unseen;
  for (Index i = 0; i < differences.size(); ++i) {
    const auto point = static_cast<std::size_t>(i);
    const bool meets_one = a.has_patch[point] != b.has_patch[point];
    Sums& sums = meets_one && region > 0.0 ? unseen : seen;
    sums.energy += differences[i];
    sums.squares += differences[i] * differences[i];
  }
  return heededPart(seen.energy, kappa * seen.squares) +
         heededPart(unseen.energy, region * unseen.squares);
}

/** Give unseen points the mean energy of those that fit, and make these means alike.
 * \param[in] unseen one for each mode
 * \param[in,out] energies one for each mode */
void
forgetUnseen(const std::vector<CalibratedMode>& modes,
             const std::vector<std::vector<char>>& unseen,
             std::vector<VectorXd>& energies)
{
  std::vector<double> means;
  for (std::size_t m = 0; m < unseen.size(); ++m) {
    const std::vector<char>& active = modes[m].estimate.scores.active;
    double sum = 0.0;
    for (std::size_t i = 0; i < active.size(); ++i)
      if (active[i])
        sum += energies[m][static_cast<Index>(i)];
    means.push_back(std::max(sum / std::max(1, modes[m].estimate.scores.num_active),
                             std::numeric_limits<double>::min()));
  }
  for (std::size_t m = 0; m < unseen.size(); ++m) {
    const double mean = std::max(*std::min_element(means.begin(), means.end()),
                                 means[m] / tolerated_misfit);
    for (Index i = 0; i < energies[m].size(); ++i)
      if (unseen[m][static_cast<std::size_t>(i)])
        energies[m][i] = mean;
      else if (modes[m].estimate.scores.active[static_cast<std::size_t>(i)])
        energies[m][i] *= mean / means[m];
  }
}

/** log of the Gaussian's integral times the prior at its mean. */
double
logVolumeOf(const CalibratedEstimate& estimate, const HeldPrior& prior)
{
  const ProductCoordinates coordinates(estimate);
  const Gaussian& gaussian = coordinates.gaussian();
  const Isometry3d pose = coordinates.pose(gaussian.mean());
  return gaussian.factor().diagonal().array().log().sum() + coordinates.logVolume() -
         twistPriorEnergy(prior, pose);
}

} // namespace

void
weighModes(const HeldPrior& prior,
           double region_of_cloud,
           const std::vector<std::vector<char>>& unseen,
           std::vector<CalibratedMode>& modes)
{
  const auto least_cost =
      std::min_element(modes.begin(), modes.end(), [](const auto& a, const auto& b) {
        return a.estimate.cost < b.estimate.cost;
      });
  const double tau = least_cost->estimate.residual_scale;
  const double kappa = least_cost->estimate.kappa_inf;
  double weight = 0.0;
  const CloudFactors factors = cloudFactors(modes);
  std::vector<VectorXd> energies;
  for (const auto& mode : modes) {
    const SurfaceScores& scores = mode.estimate.scores;
    weight += energyWeight(mode.estimate) / static_cast<double>(modes.size());
    VectorXd of_points = energiesOf(scores, tau, region_of_cloud == 0.0);
    of_points.head(scores.num_source_points) *= factors.source;
    of_points.tail(of_points.size() - scores.num_source_points) *= factors.target;
    energies.push_back(std::move(of_points));
  }
  forgetUnseen(modes, unseen, energies);
  const bool are_alike =
      !unseen.empty() && std::all_of(modes.begin(), modes.end(), [](const auto& mode) {
        return mode.estimate.keep.minCoeff() > 0.0;
      });
  const auto best = static_cast<std::size_t>(
      std::min_element(energies.begin(),
                       energies.end(),
                       [](const auto& a, const auto& b) { return a.sum() < b.sum(); }) -
      energies.begin());
  // Half of the points are of each cloud. With source points alone, k is half as large.
  const double region =
      0.5 * region_of_cloud * static_cast<double>(energies[best].size());
  for (std::size_t m = 0; m < modes.size(); ++m) {
    const double energy = heededEnergy(energies[m] - energies[best],
                                       modes[m].estimate.scores,
                                       modes[best].estimate.scores,
                                       kappa,
                                       region);
    const CalibratedEstimate& estimate = modes[m].estimate;
    const double log_prior = are_alike ? -twistPriorEnergy(prior, estimate.mode)
                                       : logVolumeOf(estimate, prior);
    const double log_weight = log_prior - weight * energy;
    modes[m].log_weight =
        std::isfinite(log_weight) ? log_weight : std::numeric_limits<double>::lowest();
  }
  std::stable_sort(modes.begin(), modes.end(), [](const auto& a, const auto& b) {
    return a.log_weight > b.log_weight;
  });
}

} // namespace bayesian_icp
