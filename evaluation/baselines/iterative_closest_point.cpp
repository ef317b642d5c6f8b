#include "baselines/iterative_closest_point.h"

#include "search/squared_gate.h"

#include <Eigen/LU>
#include <Eigen/SVD>

#include <cmath>

namespace bayesian_icp {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr double min_pairs = 3.0;

/** The mean, or the origin where points that no search in single precision finds have
 * drawn it out of the range of a float. */
Vector3d
centreOf(const Eigen::Matrix3Xd& source)
{
  if (source.cols() == 0)
    return Vector3d::Zero();
  const Vector3d mean = source.rowwise().mean();
  return mean.cast<float>().allFinite() ? mean : Vector3d(Vector3d::Zero());
}

/** Whether the step is as small as the options ask. */
bool
isSmall(const Isometry3d& step, const IcpOptions& options)
{
  const double min_cosine = options.rotation_epsilon > 0.0
                                ? options.rotation_epsilon
                                : 1.0 - options.transformation_epsilon;
  const double cosine = 0.5 * (step.linear().trace() - 1.0);
  return cosine >= min_cosine &&
         step.translation().squaredNorm() <= options.transformation_epsilon;
}

/** Whether ICP ends after an iteration, and by what.
 * \param[in] last mean squared distance of the iteration before */
bool
hasEnded(const Isometry3d& step,
         double last,
         const IcpOptions& options,
         IcpResult& result)
{
  const double change = std::abs(result.mean_squared_distance - last);
  if (result.num_iterations >= options.max_iterations)
    result.stop = IcpStop::MaxIterations;
  else if (isSmall(step, options))
    result.stop = IcpStop::Transformation;
  else if (change < options.absolute_fitness_epsilon)
    result.stop = IcpStop::AbsoluteFitness;
  else if (change / last < options.euclidean_fitness_epsilon)
    result.stop = IcpStop::RelativeFitness;
  else
    return false;
  result.has_converged = true;
  return true;
}

} // namespace

const char*
toString(IcpStop stop)
{
  switch (stop) {
  case IcpStop::TooFewPairs:
    return "too_few_pairs";
  case IcpStop::MaxIterations:
    return "max_iterations";
  case IcpStop::Transformation:
    return "transformation";
  case IcpStop::AbsoluteFitness:
    return "absolute_fitness";
  case IcpStop::RelativeFitness:
    return "relative_fitness";
  }
  return "";
}

IcpRunner::IcpRunner(const Eigen::Matrix3Xd& source, const KdTree& target)
: source_(source)
, target_(target)
, source_centre_(centreOf(source))
, neighbors_(static_cast<std::size_t>(source.cols()), KdTree::none)
{}

IcpRunner::Pairs
IcpRunner::findPairs(const Isometry3d& T_target_source, float max_squared_distance)
{
  const Matrix3d rotation = T_target_source.linear();
  Pairs pairs;
  pairs.moved_origin = T_target_source * source_centre_;
  for (Index i = 0; i < source_.cols(); ++i) {
    const Vector3d moved = rotation * (source_.col(i) - source_centre_);
    std::uint32_t& hint = neighbors_[static_cast<std::size_t>(i)];
    const KdTree::Neighbor neighbor = target_.nearest(
        (moved + pairs.moved_origin).cast<float>(), max_squared_distance, hint);
    if (neighbor.index == KdTree::none)
      continue;
    hint = neighbor.index;
    const Vector3d found = target_.points().col(neighbor.index).cast<double>();
    // About the first one, so that pairs with one and the same target point have
    // products of exactly zero, and no rotation comes of rounding.
    if (pairs.count == 0.0)
      pairs.target_origin = found;
    const Vector3d target = found - pairs.target_origin;
    pairs.count += 1.0;
    pairs.squared_distances += static_cast<double>(neighbor.squared_distance);
    pairs.moved += moved;
    pairs.target += target;
    pairs.products.noalias() += target * moved.transpose();
  }
  return pairs;
}

/** Umeyama, *Least-squares estimation of transformation parameters between two point
 * patterns* (1991), eq. 38-41 without scale. */
Isometry3d
IcpRunner::stepOf(const Pairs& pairs)
{
  const Vector3d moved = pairs.moved / pairs.count;
  const Vector3d target = pairs.target / pairs.count;
  const Matrix3d covariance = pairs.products / pairs.count - target * moved.transpose();
  const Eigen::JacobiSVD<Matrix3d> svd(covariance,
                                       Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3d signs = Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0)
    signs[2] = -1.0;
  Isometry3d step;
  step.linear() = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  step.translation() =
      pairs.target_origin + target - step.linear() * (pairs.moved_origin + moved);
  step.makeAffine();
  return step;
}

IcpResult
IcpRunner::run(const Isometry3d& start, const IcpOptions& options)
{
  const float gate = squaredGate(options.max_distance);
  IcpResult result;
  result.T_target_source = start;
  double last = std::numeric_limits<double>::max();
  for (;;) {
    const Pairs pairs = findPairs(result.T_target_source, gate);
    if (pairs.count < min_pairs) {
      result.has_converged = false;
      result.stop = IcpStop::TooFewPairs;
      return result;
    }
    const Isometry3d step = stepOf(pairs);
    result.T_target_source = step * result.T_target_source;
    ++result.num_iterations;
    result.mean_squared_distance = pairs.squared_distances / pairs.count;
    if (hasEnded(step, last, options, result))
      return result;
    last = result.mean_squared_distance;
  }
}

IcpResult
iterativeClosestPoint(const Eigen::Matrix3Xd& source,
                      const KdTree& target,
                      const Isometry3d& start,
                      const IcpOptions& options)
{
  return IcpRunner(source, target).run(start, options);
}

} // namespace bayesian_icp
