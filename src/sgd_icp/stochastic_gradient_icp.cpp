#include "options/enumerator_names.h"
#include "options/option_checker.h"
#include "paper/matched_batch.h"

#include <bayesian_icp/stochastic_gradient_icp.h>

#include <cmath>

namespace bayesian_icp {

namespace {

/** Fewer pairs do not determine a pose. */
constexpr std::size_t min_batch_pairs = 3;
/** The descent gives up after this number of mini-batches with too few pairs. */
constexpr int max_skipped_batches = 100;

/** Whether a pose has not moved from where it came to rest. */
bool
isStill(const Vector6d& pose,
        const Vector6d& rest,
        const StochasticGradientIcpOptions& options)
{
  double sum_of_angles = 0.0;
  for (int k = 3; k < 6; ++k)
    sum_of_angles += std::abs(wrapAngle(pose[k] - rest[k]));
  return (pose - rest).head<3>().norm() < options.translation_epsilon &&
         sum_of_angles < options.rotation_epsilon;
}

DescentEnd
descend(const Eigen::Matrix3Xd& source_points,
        const CorrespondenceSearch& search,
        const StochasticGradientIcpOptions& options,
        const StochasticGradientIcpProgress& progress,
        StochasticGradientIcpResult& result)
{
  MatchedBatch batch(source_points,
                     search,
                     MiniBatches(static_cast<std::size_t>(source_points.cols()),
                                 static_cast<std::size_t>(options.batch_size),
                                 MiniBatchSampling::ShuffledEpochs));
  Random random(options.seed, 0);
  // The whole source again would give the same pairs.
  int num_skips_left =
      options.batch_size < source_points.cols() ? max_skipped_batches : 1;
  const auto optimizer = makeDescentOptimizer(options.optimizer, options.step_size);
  Vector6d rest = result.pose;
  int num_still = 0;
  while (result.num_iterations < options.max_iterations) {
    batch.draw(result.pose, random);
    if (options.is_one_to_one)
      batch.makeOneToOne();
    if (batch.numMatched() < min_batch_pairs) {
      if (--num_skips_left == 0)
        return DescentEnd::TooFewCorrespondences;
      continue;
    }
    // Mean over the pairs, where meanGradient() is that over all points.
    const Vector6d gradient = static_cast<double>(batch.numPoints()) /
                              static_cast<double>(batch.numMatched()) *
                              batch.meanGradient();
    const Vector6d pose = result.pose + optimizer->step(gradient);
    if (!pose.allFinite())
      return DescentEnd::Diverged;
    result.pose = pose;
    ++result.num_iterations;
    if (progress && !progress(result.num_iterations, pose))
      return DescentEnd::Cancelled;
    if (!isStill(pose, rest, options)) {
      rest = pose;
      num_still = 0;
    }
    else if (++num_still >= options.num_still_iterations) {
      return DescentEnd::Converged;
    }
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
  return nameOf(end,
                {"converged",
                 "max_iterations",
                 "too_few_correspondences",
                 "diverged",
                 "interrupted",
                 "invalid_input"});
}

StochasticGradientIcpResult
stochasticGradientIcp(const Eigen::Matrix3Xd& source_points,
                      const CorrespondenceSearch& search,
                      const Vector6d& initial_pose,
                      const StochasticGradientIcpOptions& options,
                      const StochasticGradientIcpProgress& progress)
{
  StochasticGradientIcpResult result;
  if (initial_pose.allFinite())
    result.pose = canonicalPose(initial_pose);
  const auto num_points = static_cast<std::size_t>(source_points.cols());
  if (!options.validate().empty() || num_points < min_batch_pairs ||
      !initial_pose.allFinite())
    return result;
  result.pose = initial_pose;
  result.end = descend(source_points, search, options, progress, result);
  result.pose = canonicalPose(result.pose);
  result.has_converged = result.end == DescentEnd::Converged;
  return result;
}

} // namespace bayesian_icp
