#include "weighted_score.h"

#include <algorithm>
#include <utility>

namespace bayesian_icp {

namespace {

/** The guard: how far the gradient may be from that of a Gaussian likelihood, posterior
 * sd = 1, at the mode and for each unit of that gradient. Below 1, it points back from
 * far out. */
constexpr double max_deviation = 3.0;
constexpr double max_relative_deviation = 0.5;

/** With a smaller part of the batch on the surface the scores say nothing. */
constexpr double min_part_with_patch = 0.5;

} // namespace

WeightedScoreModel::WeightedScoreModel(const CalibratedEstimate& the_estimate,
                                       const Prior& the_prior)
: estimate(the_estimate)
, prior(the_prior)
, coordinates(the_estimate)
{
  if (coordinates.numPriorOnly() == 6)
    return;
  for (std::size_t i = 0; i < estimate.scores.active.size(); ++i)
    if (estimate.scores.active[i])
      active.push_back(i);
}

WeightedScore::WeightedScore(const WeightedScoreModel& model, BatchScore score)
: model_(model)
, score_(std::move(score))
, shuffled_(model.active)
{}

SplitGradient
WeightedScore::gradient(const Vector6d& z, std::size_t batch_size, Random& random)
{
  const ProductCoordinates& coordinates = model_.coordinates;
  SplitGradient result = {Vector6d::Zero(), coordinates.priorGradient(z, model_.prior)};
  if (!model_.active.empty())
    result.likelihood = guarded(
        z, coordinates.scoreWeights() * totalScore(z, drawBatch(batch_size, random)));
  return result;
}

const std::vector<std::size_t>&
WeightedScore::drawBatch(std::size_t size, Random& random)
{
  // Always in the order of the model, so that a batch of all points has no noise.
  if (size >= shuffled_.size())
    return model_.active;
  // The first steps of a Fisher-Yates shuffle.
  batch_.resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    std::swap(shuffled_[i], shuffled_[i + random.index(shuffled_.size() - i)]);
    batch_[i] = shuffled_[i];
  }
  return batch_;
}

/** The control variate is the score to first order about the mode, without new
 * correspondences: exact for all points, and most of the noise of a batch. */
Vector6d
WeightedScore::totalScore(const Vector6d& z, const std::vector<std::size_t>& batch)
{
  const SurfaceScores& at_mode = model_.estimate.scores;
  const Vector6d xi = model_.coordinates.scoredTwist(z);
  Vector6d linear = at_mode.total + at_mode.information * xi;
  Vector6d difference;
  const int num_with_patch =
      score_(model_.coordinates.scoredPose(z), batch, difference);
  const auto size = static_cast<double>(batch.size());
  if (num_with_patch < min_part_with_patch * size || !difference.allFinite())
    return linear;
  for (const std::size_t point : batch) {
    const auto column = static_cast<Eigen::Index>(point);
    const auto jacobian = at_mode.jacobians.col(column);
    difference -= at_mode.scores.col(column) + jacobian * jacobian.dot(xi);
  }
  return linear + static_cast<double>(model_.active.size()) / size * difference;
}

Vector6d
WeightedScore::guarded(const Vector6d& z, const Vector6d& likelihood) const
{
  const Matrix6d& L = model_.coordinates.gaussian().factor();
  const Vector6d linear = model_.coordinates.linearGradient(z);
  const Vector6d deviation = shape_gain_ * (likelihood - linear);
  const double limit =
      max_deviation + max_relative_deviation * (L.transpose() * linear).norm();
  const double length = (L.transpose() * deviation).norm();
  return linear + std::min(1.0, limit / std::max(length, 1e-12)) * deviation;
}

Matrix6d
WeightedScore::termCovariance(int num_positions, int num_points, Random& random)
{
  Matrix6d sum = Matrix6d::Zero();
  if (model_.active.empty())
    return sum;
  const SurfaceScores& at_mode = model_.estimate.scores;
  const auto num_terms = static_cast<double>(model_.active.size());
  for (int i = 0; i < num_positions; ++i) {
    const Vector6d z = model_.coordinates.gaussian().draw(random);
    const Vector6d xi = model_.coordinates.scoredTwist(z);
    const Eigen::Isometry3d pose = model_.coordinates.scoredPose(z);
    Matrix6Xd terms(6, num_points);
    for (int k = 0; k < num_points; ++k) {
      const std::vector<std::size_t> point = {
          model_.active[random.index(model_.active.size())]};
      const auto column = static_cast<Eigen::Index>(point.front());
      const auto jacobian = at_mode.jacobians.col(column);
      Vector6d score;
      score_(pose, point, score);
      if (!score.allFinite())
        score.setZero();
      terms.col(k) = num_terms *
                     (score - at_mode.scores.col(column) - jacobian * jacobian.dot(xi));
    }
    terms.colwise() -= terms.rowwise().mean().eval();
    sum += terms * terms.transpose() / (num_points - 1);
  }
  const Matrix6d& B = model_.coordinates.scoreWeights();
  return B * (sum / num_positions) * B.transpose();
}

} // namespace bayesian_icp
