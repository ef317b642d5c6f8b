#include "calibrated/calibrated.h"
#include "calibrated/cloud_parts.h"
#include "exact/exact.h"
#include "paper/paper.h"
#include "summary/estimates.h"

#include <bayesian_icp/pipeline.h>
#include <bayesian_icp/tree_search.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace bayesian_icp {

namespace {

/** A chain has run away if its translation is further than this number of prior
 * standard deviations from the prior mean, plus the deviation of its start and the size
 * of the source. For angles, whose prior is periodic, see SgldChain::isWhiteNoise(). */
constexpr double max_prior_deviations = 20.0;

std::size_t
countCorrespondences(const Eigen::Matrix3Xd& source_points,
                     const CorrespondenceSearch& search,
                     const Vector6d& pose)
{
  std::vector<std::size_t> all(static_cast<std::size_t>(source_points.cols()));
  std::iota(all.begin(), all.end(), std::size_t(0));
  Eigen::Matrix3Xd moved_points;
  movePoints(pose, source_points, moved_points);
  Correspondences correspondences;
  search.find(pose, all, moved_points, correspondences);
  return correspondences.size();
}

/** Largest translation from the prior mean that is not called divergence [m]. */
Eigen::Vector3d
translationLimit(const Prior& prior,
                 const Vector6d& initial_pose,
                 const Eigen::Matrix3Xd& source_points)
{
  const Eigen::Vector3d size =
      source_points.rowwise().maxCoeff() - source_points.rowwise().minCoeff();
  const Vector6d limit = max_prior_deviations * prior.variance().cwiseSqrt() +
                         prior.deviation(initial_pose).cwiseAbs();
  return limit.head<3>().array() + size.norm();
}

PosteriorEstimate
estimate(const Eigen::Matrix3Xd& source_points,
         const CorrespondenceSearch& search,
         const Target& target,
         const Vector6d& initial_pose,
         const Options& options,
         const ProgressCallback& progress)
{
  if (auto refusal = refusalOf(source_points, initial_pose, options))
    return std::move(*refusal);
  const std::size_t found = countCorrespondences(source_points, search, initial_pose);
  if (found < min_correspondences)
    return failure(Status::TooFewCorrespondences,
                   "only " + std::to_string(found) + " of " +
                       std::to_string(source_points.cols()) +
                       " source points have a target point within the maximum "
                       "correspondence distance at the initial guess");
  const Prior prior = priorOf(options, initial_pose, source_points);
  const Eigen::Vector3d limit = translationLimit(prior, initial_pose, source_points);
  const auto has_diverged = [&prior, &limit](const Vector6d& pose) {
    const Eigen::Vector3d translation = prior.deviation(pose).head<3>();
    return (translation.cwiseAbs().array() > limit.array()).any();
  };
  if (options.preset == Preset::Exact)
    return estimateExact(
        source_points, target, prior, initial_pose, options, has_diverged, progress);
  return estimateOf(samplePaper(source_points,
                                search,
                                prior,
                                initial_pose,
                                options.paper,
                                options.chains,
                                has_diverged,
                                progress),
                    prior);
}

} // namespace

PosteriorEstimate
estimatePosterior(const Eigen::Matrix3Xd& source_points,
                  const CorrespondenceSearch& search,
                  const Vector6d& initial_pose,
                  const Options& options,
                  const ProgressCallback& progress)
{
  if (options.preset == Preset::Calibrated)
    return failure(Status::InvalidOptions,
                   "preset is calibrated, but must be paper or exact with a search of "
                   "the user's own: calibrated needs the target's points");
  if (options.preset == Preset::Exact &&
      options.exact.residual.residual != Residual::PointToPoint)
    return failure(Status::InvalidOptions,
                   std::string("residual is ") +
                       toString(options.exact.residual.residual) +
                       ", but must be point-to-point: a search of the user's own gives "
                       "no normals");
  // The search knows points by their index in the whole source, so it is not thinned.
  Options whole_source = options;
  whole_source.exact.max_source_points =
      std::max(options.exact.max_source_points, static_cast<int>(source_points.cols()));
  return estimate(source_points,
                  search,
                  SearchTarget(search),
                  initial_pose,
                  whole_source,
                  progress);
}

PosteriorEstimate
estimatePosterior(const Eigen::Matrix3Xd& source_points,
                  const KdTree& target_tree,
                  const Vector6d& initial_pose,
                  const Options& options,
                  const ProgressCallback& progress)
{
  if (options.preset == Preset::Calibrated)
    return estimatePosterior(source_points,
                             target_tree.points().cast<double>(),
                             initial_pose,
                             options,
                             progress);
  const bool is_exact = options.preset == Preset::Exact;
  const Residual residual = options.exact.residual.residual;
  if (is_exact && residual != Residual::PointToPoint && target_tree.size() < 3)
    return failure(Status::TooFewCorrespondences,
                   std::string("residual ") + toString(residual) +
                       " needs a target of at least 3 points, which has " +
                       std::to_string(target_tree.size()));
  const double max_distance =
      is_exact ? options.exact.residual.max_distance : options.paper.max_distance;
  return estimate(source_points,
                  TreeSearch(target_tree, max_distance),
                  is_exact ? treeTargetFor(options.exact.residual, target_tree)
                           : TreeTarget(target_tree, max_distance),
                  initial_pose,
                  options,
                  progress);
}

PosteriorEstimate
estimatePosterior(const PreparedCloud& source,
                  const PreparedCloud& target,
                  const Vector6d& initial_pose,
                  const Options& options,
                  const ProgressCallback& progress)
{
  if (options.preset == Preset::Calibrated)
    return estimateCalibratedPosterior(source, target, initial_pose, options, progress);
  const std::string complaint = options.validate();
  if (!complaint.empty())
    return failure(Status::InvalidOptions, complaint);
  return estimatePosterior(source.points(),
                           target.parts().tree(options.chains.num_threads),
                           initial_pose,
                           options,
                           progress);
}

} // namespace bayesian_icp
