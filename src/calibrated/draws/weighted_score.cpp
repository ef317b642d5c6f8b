#include "calibrated/draws/weighted_score.h"

#include <algorithm>
#include <utility>

namespace bayesian_icp {

namespace {

/** The guard: largest deviation of a gradient from that of a Gaussian, in units in
 * which the posterior's standard deviation is 1. max_deviation is the limit at the
 * mode, and max_relative_deviation is added for each unit of the Gaussian's gradient.
 * As it is below 1, the gradient points back from far out. */
constexpr double max_deviation = 3.0;
constexpr double max_relative_deviation = 0.5;

/** Scores are not used if a smaller fraction of the batch is on the surface. */
constexpr double min_part_with_patch = 0.5;

/** Points that batches are drawn from; none if the prior alone holds the pose. */
std::vector<std::size_t>
activePoints(const CalibratedEstimate& estimate, const ProductCoordinates& coordinates)
{
  std::vector<std::size_t> active;
  if (coordinates.numPriorOnly() == 6)
    return active;
  for (std::size_t i = 0; i < estimate.scores.active.size(); ++i)
    if (estimate.scores.active[i])
      active.push_back(i);
  return active;
}

} // namespace

WeightedScore::WeightedScore(const CalibratedEstimate& estimate,
                             const HeldPrior& prior,
                             BatchScore score)
: estimate_(estimate)
, prior_(prior)
, score_(std::move(score))
, coordinates_(estimate)
, active_(activePoints(estimate, coordinates_))
, batches_(active_)
{}

SplitGradient
WeightedScore::gradient(const Vector6d& z, std::size_t batch_size, Random& random)
{
  const Vector6d linear = coordinates_.linearGradient(z);
  const Gaussian& gaussian = coordinates_.gaussian();
  const Vector6d linear_prior =
      gaussian.precision() * (coordinates_.unwound(z) - gaussian.mean()) - linear;
  const Vector6d prior =
      coordinates_.priorGradient(z, prior_) - coordinates_.volumeGradient(z);
  SplitGradient result = {Vector6d::Zero(),
                          guarded(linear_prior, prior - linear_prior)};
  if (!active_.empty()) {
    const Vector6d likelihood = coordinates_.scoreWeights() *
                                totalScore(z, batches_.subset(batch_size, random));
    result.likelihood = guarded(linear, shape_gain_ * (likelihood - linear));
  }
  return result;
}

/** The control variate is the score to first order about the mode, without new
 * correspondences. It is exact for all points, and contains most of the noise of a
 * batch. */
Vector6d
WeightedScore::totalScore(const Vector6d& z, const std::vector<std::size_t>& batch)
{
  const SurfaceScores& at_mode = estimate_.scores;
  const Vector6d xi = coordinates_.scoredTwist(z);
  Vector6d linear = at_mode.total + at_mode.information * xi;
  Vector6d difference;
  const int num_with_patch =
      score_(estimate_, coordinates_.scoredPose(z), batch, hints_, difference);
  const auto size = static_cast<double>(batch.size());
  if (num_with_patch < min_part_with_patch * size || !difference.allFinite())
    return linear;
  for (const std::size_t point : batch) {
    const auto column = static_cast<Eigen::Index>(point);
    const auto jacobian = at_mode.jacobians.col(column);
    difference -= at_mode.scores.col(column) + jacobian * jacobian.dot(xi);
  }
  return linear + static_cast<double>(active_.size()) / size * difference;
}

Vector6d
WeightedScore::guarded(const Vector6d& linear, const Vector6d& deviation) const
{
  const Matrix6d& L = coordinates_.gaussian().factor();
  const double limit =
      max_deviation + max_relative_deviation * (L.transpose() * linear).norm();
  const double length = (L.transpose() * deviation).norm();
  return linear + std::min(1.0, limit / std::max(length, 1e-12)) * deviation;
}

Matrix6d
WeightedScore::termCovariance(int num_positions, int num_points, Random& random)
{
  Matrix6d sum = Matrix6d::Zero();
  if (active_.empty())
    return sum;
  const SurfaceScores& at_mode = estimate_.scores;
  const auto num_terms = static_cast<double>(active_.size());
  for (int i = 0; i < num_positions; ++i) {
    const Vector6d z = coordinates_.gaussian().draw(random);
    const Vector6d xi = coordinates_.scoredTwist(z);
    const Eigen::Isometry3d pose = coordinates_.scoredPose(z);
    Matrix6Xd terms(6, num_points);
    for (int k = 0; k < num_points; ++k) {
      const std::vector<std::size_t> point = {active_[random.index(active_.size())]};
      const auto column = static_cast<Eigen::Index>(point.front());
      const auto jacobian = at_mode.jacobians.col(column);
      Vector6d score;
      score_(estimate_, pose, point, hints_, score);
      if (!score.allFinite())
        score.setZero();
      terms.col(k) = num_terms *
                     (score - at_mode.scores.col(column) - jacobian * jacobian.dot(xi));
    }
    terms.colwise() -= terms.rowwise().mean().eval();
    sum += terms * terms.transpose() / (num_points - 1);
  }
  const Matrix6d& B = coordinates_.scoreWeights();
  return B * (sum / num_positions) * B.transpose();
}

} // namespace bayesian_icp
