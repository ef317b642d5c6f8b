// The method from top to bottom; numbers are those of the sections of
// docs/calibration.md.
#include "calibrated/calibrated.h"

#include "calibrated/calibrated_estimate.h"
#include "calibrated/calibrated_report.h"
#include "calibrated/draws/calibrated_draws.h"
#include "calibrated/modes/calibrated_modes.h"
#include "calibrated/surface/distinct_points.h"
#include "summary/estimates.h"
#include "summary/plain_text.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <vector>

namespace bayesian_icp {

namespace {

/** A target that is narrower than this, in standard deviations of the noise, is a line.
 * Patches that are fitted to its noise would hold motions along it. */
constexpr double min_width_to_noise = 3.0;

std::string
textOfCount(Eigen::Index num_points)
{
  return std::to_string(num_points) + " finite points, but preset calibrated needs " +
         std::to_string(min_calibrated_points);
}

/** What is wrong with the arguments; the status is NotRun if nothing is. */
PosteriorEstimate
checkInput(const Eigen::Matrix3Xd& source_points,
           const Eigen::Matrix3Xd& target_points,
           const Vector6d& initial_pose,
           const Options& options)
{
  PosteriorEstimate checked = checkArguments(source_points, initial_pose, options);
  if (checked.summary.status != Status::NotRun)
    return checked;
  if (source_points.cols() < min_calibrated_points)
    return failure(Status::InvalidInput,
                   "the source has " + textOfCount(source_points.cols()));
  const Eigen::Index num_finite =
      (target_points.array().isFinite().cast<int>().colwise().sum() == 3).count();
  if (num_finite < min_calibrated_points)
    return failure(Status::InvalidInput, "the target has " + textOfCount(num_finite));
  return checked;
}

/** Reports progress of unknown length. Returns whether the user cancels. */
bool
isCancelled(const ProgressCallback& progress)
{
  return progress && !progress({0, 0, 0, 0});
}

/** Standard deviation of the points across the line that fits them best, where they are
 * widest [m]. */
double
widthOf(const Eigen::Matrix3Xd& points)
{
  const Eigen::Matrix3Xd centred = points.colwise() - points.rowwise().mean();
  const Eigen::Matrix3d covariance =
      centred * centred.transpose() / static_cast<double>(points.cols());
  const double variance =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly)
          .eigenvalues()[1];
  return std::sqrt(std::max(variance, 0.0));
}

/** Why distances to the target's surface mean nothing; empty if they do. */
std::string
complaintAbout(const SurfaceModel& model, const Eigen::Matrix3Xd& target_points)
{
  if (!(model.usableFraction() > 0.0))
    return "the target has no usable surface: its points are too noisy, too sparse or "
           "too tangled for distances to a surface";
  if (!(model.medianSigma() > 0.0))
    return "the target's points lie on their surface exactly: without noise there is "
           "no scale";
  const double width = widthOf(target_points);
  if (width < min_width_to_noise * model.medianSigma())
    return formatted("the target has no surface: it is a line to within %.2g m, %.1f "
                     "times its noise (at least %.0f)",
                     width,
                     width / model.medianSigma(),
                     min_width_to_noise);
  return std::string();
}

/** Why there is nothing to draw from; empty if there is. */
std::string
complaintAbout(const CalibratedEstimate& estimate, Eigen::Index num_source_points)
{
  if (estimate.scores.num_active < min_calibrated_points)
    return "only " + std::to_string(estimate.scores.num_active) + " of " +
           std::to_string(num_source_points) +
           " source points lie on a usable surface of the target at the best pose";
  if (!estimate.mode.matrix().allFinite() || !estimate.covariance.allFinite() ||
      !estimate.mean.allFinite())
    return "the scores of the source points do not give a finite covariance (clouds "
           "without noise have no scale)";
  return std::string();
}

/** The motions that the prior alone holds, for the message; empty if there are none. */
std::string
whatThePriorHolds(const std::vector<DataDirection>& directions)
{
  std::string text;
  for (const DataDirection& direction : directions)
    if (direction.observability == Observability::PriorOnly)
      text +=
          (text.empty() ? "; held by the prior alone: " : ", ") + direction.description;
  return text;
}

PosteriorEstimate
estimateAndDraw(const SurfaceScorer& scorer,
                const Prior& prior,
                const Options& options,
                const ProgressCallback& progress)
{
  const Eigen::Index num_points = scorer.sourcePoints().cols();
  ModeSearchOptions search;
  search.seed = options.chains.seed;
  search.estimate.num_mode_points = options.calibrated.num_mode_points;
  // 3 to 7, in estimateCalibrated() for each mode.
  const std::vector<CalibratedMode> modes = calibratedModes(scorer, prior, search);
  const CalibratedEstimate& heaviest = modes.front().estimate;
  const std::string complaint = complaintAbout(heaviest, num_points);
  if (!complaint.empty())
    return failure(Status::TooFewCorrespondences, complaint);
  if (isCancelled(progress))
    return failure(Status::Cancelled, "interrupted before the first draw");

  // 8: draws.
  PosteriorEstimate result = estimateOf(sampleCalibrated(
      scoresOf(scorer), prior, modes, options.calibrated, options.chains, progress));
  // 9: report.
  if (result.summary.status == Status::SeveralModes)
    result.summary.message += "; the report of the data is of the heaviest";
  result.summary.data =
      dataReportOf(heaviest, static_cast<std::size_t>(num_points), scorer.model());
  result.summary.message += whatThePriorHolds(result.summary.data.directions);
  addDoubts(describeFlags(result.summary.data), result.summary);
  return result;
}

} // namespace

PosteriorEstimate
estimateCalibratedPosterior(const Eigen::Matrix3Xd& source_points,
                            const Eigen::Matrix3Xd& target_points,
                            const Vector6d& initial_pose,
                            const Options& options,
                            const ProgressCallback& progress)
{
  PosteriorEstimate checked =
      checkInput(source_points, target_points, initial_pose, options);
  if (checked.summary.status != Status::NotRun)
    return checked;
  if (isCancelled(progress))
    return failure(Status::Cancelled, "interrupted before the first draw");
  const Eigen::Matrix3Xd distinct_points = distinctPoints(target_points);
  if (distinct_points.cols() < min_calibrated_points)
    return failure(Status::TooFewCorrespondences,
                   "the target has no surface: only " +
                       std::to_string(distinct_points.cols()) +
                       " of its points differ");
  // 1: the target as a surface.
  const SurfaceModel model(
      distinct_points, SurfaceModelOptions(), options.chains.num_threads);
  const std::string no_surface = complaintAbout(model, distinct_points);
  if (!no_surface.empty())
    return failure(Status::TooFewCorrespondences, no_surface);
  // 2: what source points say.
  const SurfaceScorer scorer(evenSource(source_points,
                                        options.calibrated.max_source_points,
                                        options.chains.seed),
                             model);
  const Prior prior = priorOf(options, initial_pose, source_points);
  return estimateAndDraw(scorer, prior, options, progress);
}

} // namespace bayesian_icp
