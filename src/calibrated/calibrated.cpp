// The method from top to bottom; numbers are those of the sections of
// docs/calibration.md.
#include "calibrated/calibrated.h"

#include "algebra/decompositions.h"
#include "calibrated/calibrated_estimate.h"
#include "calibrated/calibrated_report.h"
#include "calibrated/cloud_parts.h"
#include "calibrated/draws/calibrated_draws.h"
#include "calibrated/flat_clouds.h"
#include "calibrated/modes/calibrated_modes.h"
#include "summary/estimates.h"

#include <optional>
#include <utility>
#include <vector>

namespace bayesian_icp {

namespace {

/** Report progress of unknown length. Returns whether the user cancels. */
bool
isCancelled(const ProgressCallback& progress)
{
  return progress && !progress({0, 0, 0, 0});
}

/** If the source's patches are more than this many times as wide as the target's, the
 * target's points are left out where more motions are held without them. */
constexpr double max_width_to_target = 2.0;

/** A posterior's modes, and the points that they come from. */
struct ModesOfPoints {
  SurfaceScorer scorer;
  std::vector<CalibratedMode> modes;

  /** Number of motions whose information is rather signal than noise, at most 6. */
  Eigen::Index
  numHeld() const
  {
    return (modes.front().estimate.keep.array() >= min_observed_share_above_noise)
        .count();
  }
};

/** 3 to 7, in estimateCalibrated() for each mode. Wide patches of a sparse source have
 * the roughness of the scene. What the target's points say of them hides what the
 * source's points say of the target's patches. */
ModesOfPoints
modesOf(const SurfaceScorer& scorer,
        double width_to_target,
        const HeldPrior& held,
        const ModeSearchOptions& search)
{
  ModesOfPoints of_both = {scorer, calibratedModes(scorer, held, search)};
  if (scorer.targetPoints().cols() == 0 || width_to_target <= max_width_to_target ||
      of_both.numHeld() == (held.plane ? 3 : 6))
    return of_both;
  const SurfaceScorer source = scorer.ofFirst(scorer.sourcePoints().cols());
  ModesOfPoints of_source = {source, calibratedModes(source, held, search)};
  if (of_source.numHeld() > of_both.numHeld())
    return of_source;
  return of_both;
}

/** Why there is no density to draw from; empty if there is one. */
std::string
complaintAbout(const CalibratedEstimate& estimate)
{
  const SurfaceScores& scores = estimate.scores;
  if (scores.num_active_of_source < min_calibrated_points)
    return "only " + std::to_string(scores.num_active_of_source) + " of " +
           std::to_string(scores.num_source_points) +
           " source points lie on a usable surface of the target at the best pose";
  if (!estimate.mode.matrix().allFinite() || !estimate.covariance.allFinite() ||
      !estimate.mean.allFinite())
    return "the scores of the source points do not give a finite covariance (clouds "
           "without noise have no scale)";
  return std::string();
}

/** Whether the precision of the prior about the source's centroid keeps what it says of
 * the motions that it holds least, by double precision. */
bool
isResolved(const Prior& prior, const Eigen::Vector3d& centroid)
{
  constexpr double smallest = 1e-14;
  const Eigen::Isometry3d mean = isometryOf(prior.mean());
  const Matrix6d precision = twistPrior(prior, mean, mean * centroid).precision;
  const Vector6d unit = precision.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix6d scaled = unit.asDiagonal() * precision * unit.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Matrix6d>(scaled).eigenvalues()[0] > smallest;
}

/** Text about the motions that the prior alone holds, for the message; empty if there
 * are none. Those out of the plane of flat clouds go without saying. */
std::string
whatThePriorHolds(const std::vector<DataDirection>& directions,
                  const std::optional<PlaneHold>& plane)
{
  std::string text;
  for (const DataDirection& direction : directions)
    if (direction.observability == Observability::PriorOnly &&
        !(plane && isOutOf(*plane, direction.twist)))
      text +=
          (text.empty() ? "; held by the prior alone: " : ", ") + direction.description;
  return text;
}

PosteriorEstimate
estimateAndDraw(const SurfaceScorer& of_clouds,
                double width_to_target,
                const Prior& prior,
                const HeldPrior& held,
                const Options& options,
                const ProgressCallback& progress)
{
  ModeSearchOptions search;
  search.seed = options.chains.seed;
  search.estimate.num_mode_points = options.calibrated.num_mode_points;
  search.estimate.num_threads = options.chains.num_threads;
  ModesOfPoints found = modesOf(of_clouds, width_to_target, held, search);
  const SurfaceScorer& scorer = found.scorer;
  CalibratedEstimate& heaviest = found.modes.front().estimate;
  const std::string complaint = complaintAbout(heaviest);
  if (!complaint.empty())
    return failure(Status::TooFewCorrespondences, complaint);
  if (isCancelled(progress))
    return failure(Status::Cancelled, "interrupted before the first draw");

  // 8: draws.
  ChainSet chains = sampleCalibrated(scoresOf(scorer),
                                     held,
                                     found.modes,
                                     options.calibrated,
                                     options.chains,
                                     progress);
  if (held.plane) {
    addMotionOutOfPlane(prior, held, options.chains.seed, chains);
    setPrior(prior, heaviest);
  }
  PosteriorEstimate result = estimateOf(std::move(chains), prior);
  // 9: report.
  if (result.summary.status == Status::SeveralModes)
    result.summary.message += "; the report of the data is of the heaviest";
  result.summary.data = dataReportOf(heaviest, scorer.noise());
  if (held.plane)
    result.summary.message += "; both clouds lie in a plane: the prior alone holds the "
                              "motions out of it";
  result.summary.message +=
      whatThePriorHolds(result.summary.data.directions, held.plane);
  addDoubts(describeFlags(result.summary.data), result.summary);
  return result;
}

} // namespace

PosteriorEstimate
estimateCalibratedPosterior(const PreparedCloud& source,
                            const PreparedCloud& target,
                            const Vector6d& initial_pose,
                            const Options& options,
                            const ProgressCallback& progress)
{
  const Eigen::Matrix3Xd& source_points = source.points();
  const int num_threads = options.chains.num_threads;
  if (auto refusal = refusalOf(source_points, initial_pose, options))
    return std::move(*refusal);
  if (source_points.cols() < min_calibrated_points)
    return failure(Status::InvalidInput,
                   "the source has " + std::to_string(source_points.cols()) +
                       " finite points, but preset calibrated needs " +
                       std::to_string(min_calibrated_points));
  if (isCancelled(progress))
    return failure(Status::Cancelled, "interrupted before the first draw");
  // 1: both clouds as surfaces.
  const PreparedSurface& target_surface =
      target.parts().surfaceFor(source.parts(), num_threads);
  if (!target_surface.complaint.empty())
    return failure(target_surface.status, target_surface.complaint);
  const PreparedSurface& source_surface =
      source.parts().surfaceFor(target.parts(), num_threads);
  if (target_surface.model.planeNormal() && !source_surface.model.planeNormal())
    return failure(Status::TooFewCorrespondences,
                   "the target lies in a plane, and the source does not: there is no "
                   "surface to compare its points with");
  // 2: what the points of both clouds say.
  const Prior prior = priorOf(options, initial_pose, source_points);
  if (!isResolved(prior, source_points.rowwise().mean()))
    return failure(
        Status::InvalidOptions,
        "the prior's variances differ too much for double precision: state "
        "the smallest ones larger, or the prior about the source's centroid");
  const SurfaceScorer scorer =
      scorerOf(source_points,
               source_surface,
               target.points(),
               target_surface,
               options.calibrated.max_source_points,
               options.chains.seed,
               num_threads,
               reachOf(source_points, source_surface.columns, prior));
  PosteriorEstimate result = estimateAndDraw(
      scorer,
      source_surface.model.medianRadius() / target_surface.model.medianRadius(),
      prior,
      heldInPlane(prior, source_surface.model, target_surface.model),
      options,
      progress);
  if (result.summary.num_draws > 0)
    addDoubts(doubtsAboutTilt(prior, source_surface.model, target_surface.model),
              result.summary);
  return result;
}

} // namespace bayesian_icp
