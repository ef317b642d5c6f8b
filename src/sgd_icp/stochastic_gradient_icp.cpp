#include "../option_checker.h"
#include "paper/matched_batch.h"

#include <bayesian_icp/stochastic_gradient_icp.h>

#include <algorithm>
#include <cmath>

namespace bayesian_icp {

namespace {

/** Fewer pairs do not determine a pose. */
constexpr std::size_t min_batch_pairs = 3;
/** The descent gives up after this number of mini-batches with too few pairs. */
constexpr int max_skipped_batches = 100;

/** Notices that a pose has come to rest. */
class RestDetector {
public:
  RestDetector(const Vector6d& start, const StochasticGradientIcpOptions& options)
  : options_(options)
  , rest_(start)
  {}

  /** Take in the pose after a step.
   * \return whether it has been still for long enough */
  bool
  update(const Vector6d& pose)
  {
    if (isStill(pose)) {
      ++num_still_;
    }
    else {
      rest_ = pose;
      num_still_ = 0;
    }
    return num_still_ >= options_.num_still_iterations;
  }

private:
  bool
  isStill(const Vector6d& pose) const
  {
    double sum_of_angles = 0.0;
    for (int k = 3; k < 6; ++k)
      sum_of_angles += std::abs(wrapAngle(pose[k] - rest_[k]));
    return (pose - rest_).head<3>().norm() < options_.translation_epsilon &&
           sum_of_angles < options_.rotation_epsilon;
  }

  const StochasticGradientIcpOptions& options_;
  Vector6d rest_;
  int num_still_ = 0;
};

/** Mini-batches that have enough correspondences, and their gradients. */
class BatchGradient {
public:
  BatchGradient(const Eigen::Matrix3Xd& source_points,
                const CorrespondenceSearch& search,
                const StochasticGradientIcpOptions& options)
  : batch_(source_points,
           search,
           MiniBatches(static_cast<std::size_t>(source_points.cols()),
                       static_cast<std::size_t>(options.batch_size),
                       MiniBatchSampling::ShuffledEpochs))
  , is_one_to_one_(options.is_one_to_one)
  , random_(options.seed, 0)
  , num_skips_left_(options.batch_size < source_points.cols() ? max_skipped_batches : 1)
  {}

  /** \return false if there were too many mini-batches with too few pairs */
  bool
  find(const Vector6d& pose)
  {
    while (num_skips_left_ > 0) {
      batch_.draw(pose, random_);
      if (is_one_to_one_)
        batch_.makeOneToOne();
      if (batch_.numMatched() >= min_batch_pairs)
        return true;
      --num_skips_left_;
    }
    return false;
  }

  /** Mean over the pairs, where meanGradient() is that over all points. */
  Vector6d
  gradient() const
  {
    return static_cast<double>(batch_.numPoints()) /
           static_cast<double>(batch_.numMatched()) * batch_.meanGradient();
  }

private:
  MatchedBatch batch_;
  bool is_one_to_one_;
  Random random_;
  int num_skips_left_;
};

DescentEnd
descend(const StochasticGradientIcpOptions& options,
        const StochasticGradientIcpProgress& progress,
        BatchGradient& batch,
        StochasticGradientIcpResult& result)
{
  const auto optimizer = makeDescentOptimizer(options.optimizer, options.step_size);
  RestDetector rest(result.pose, options);
  while (result.num_iterations < options.max_iterations) {
    if (!batch.find(result.pose))
      return DescentEnd::TooFewCorrespondences;
    const Vector6d pose = result.pose + optimizer->step(batch.gradient());
    if (!pose.allFinite())
      return DescentEnd::Diverged;
    result.pose = pose;
    ++result.num_iterations;
    if (progress && !progress(result.num_iterations, pose))
      return DescentEnd::Cancelled;
    if (rest.update(pose))
      return DescentEnd::Converged;
  }
  return DescentEnd::MaxIterations;
}

} // namespace

std::string
StochasticGradientIcpOptions::validate() const
{
  Checker checker;
  if (!std::isnan(step_size))
    checker.positive("step_size", step_size);
  checker.atLeast("batch_size", batch_size, 1);
  checker.atLeast("max_iterations", max_iterations, 1);
  checker.require(translation_epsilon >= 0.0,
                  "translation_epsilon",
                  translation_epsilon,
                  "positive or 0 (m)");
  checker.require(rotation_epsilon >= 0.0,
                  "rotation_epsilon",
                  rotation_epsilon,
                  "positive or 0 (rad)");
  checker.atLeast("num_still_iterations", num_still_iterations, 1);
  return checker.complaint();
}

const char*
toString(DescentEnd end)
{
  switch (end) {
  case DescentEnd::Converged:
    return "converged";
  case DescentEnd::MaxIterations:
    return "max_iterations";
  case DescentEnd::TooFewCorrespondences:
    return "too_few_correspondences";
  case DescentEnd::Diverged:
    return "diverged";
  case DescentEnd::Cancelled:
    return "interrupted";
  case DescentEnd::InvalidInput:
    return "invalid_input";
  }
  return "unknown";
}

StochasticGradientIcpResult
stochasticGradientIcp(const Eigen::Matrix3Xd& source_points,
                      const CorrespondenceSearch& search,
                      const Vector6d& initial_pose,
                      const StochasticGradientIcpOptions& options,
                      const StochasticGradientIcpProgress& progress)
{
  StochasticGradientIcpResult result;
  result.pose = initial_pose;
  const auto num_points = static_cast<std::size_t>(source_points.cols());
  if (!options.validate().empty() || num_points < min_batch_pairs ||
      !initial_pose.allFinite())
    return result;
  BatchGradient batch(source_points, search, options);
  result.end = descend(options, progress, batch, result);
  result.pose = canonicalPose(result.pose);
  result.has_converged = result.end == DescentEnd::Converged;
  return result;
}

} // namespace bayesian_icp
