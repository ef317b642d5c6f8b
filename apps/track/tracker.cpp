#include "track/tracker.h"

#include "io/cloud_file.h"
#include "io/errors.h"
#include "localization/stated_pose.h"

#include <bayesian_icp/measurement.h>
#include <bayesian_icp/pipeline.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>

namespace bayesian_icp::app {

namespace {

/** The first point of each cube of this width, in their order. */
Eigen::Matrix3Xd
thinned(const Eigen::Matrix3Xd& points, double voxel_size)
{
  using Voxel = std::array<std::int64_t, 3>;
  std::vector<std::pair<Voxel, Eigen::Index>> voxels;
  voxels.reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    Voxel voxel;
    for (int axis = 0; axis < 3; ++axis)
      voxel[static_cast<std::size_t>(axis)] =
          static_cast<std::int64_t>(std::floor(points(axis, i) / voxel_size));
    voxels.emplace_back(voxel, i);
  }
  std::sort(voxels.begin(), voxels.end());
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if (i == 0 || voxels[i].first != voxels[i - 1].first)
      kept.push_back(voxels[i].second);
  std::sort(kept.begin(), kept.end());
  return points(Eigen::all, kept);
}

/** As a prior is stated to the library. */
StatedPose
statedPoseOf(const GaussianPose& pose)
{
  StatedPose stated;
  const Eigen::Matrix3d R = rotationOf(pose.mean);
  stated.position = pose.mean.head<3>();
  stated.orientation = R;
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = R;
  stated.covariance = turn * pose.covariance * turn.transpose();
  return stated;
}

} // namespace

MotionModel
motionModelOf(const TrackRequest& request)
{
  const PriorOptions& prior = request.settings.options.prior;
  const double seconds = request.times.at(1) - request.times.at(0);
  MotionModel model;
  model.velocity =
      logSE3(prior.mean.allFinite() ? matrixOf(prior.mean) : request.settings.guess) /
      seconds;
  model.velocity_covariance = (prior.variance / (seconds * seconds)).asDiagonal();
  model.acceleration = request.acceleration;
  model.angular_acceleration = request.angular_acceleration;
  return model;
}

Tracker::Tracker(const TrackRequest& request, const Track& track)
: request_(request)
, track_(track)
{}

Tracker::~Tracker() = default;

void
Tracker::prepareTarget()
{
  if (prepared_target_ == track_.target())
    return;
  std::vector<Eigen::Matrix3Xd> parts;
  Eigen::Index size = 0;
  for (const auto& [scan, T_target_scan] : track_.targetScans()) {
    if (points_.count(scan) == 0) // of a track that was interrupted
      points_[scan] =
          io::readFinitePoints(request_.scans.at(static_cast<std::size_t>(scan)))
              .cast<double>();
    parts.emplace_back();
    movePoints(poseOf(T_target_scan), points_[scan], parts.back());
    size += parts.back().cols();
  }
  points_.clear();
  Eigen::Matrix3Xd all(3, size);
  size = 0;
  for (const auto& part : parts) {
    all.middleCols(size, part.cols()) = part;
    size += part.cols();
  }
  target_points_ = std::make_unique<PreparedTarget>(
      request_.voxel_size > 0.0 ? thinned(all, request_.voxel_size) : all);
  prepared_target_ = track_.target();
}

Tracker::Attempt
Tracker::registerTo(const Eigen::Matrix3Xd& points,
                    bool is_velocity_doubted,
                    const ProgressCallback& progress) const
{
  Attempt attempt;
  TrackStep& step = attempt.step;
  step.is_velocity_doubted = is_velocity_doubted;
  Options options = request_.settings.options;
  double widening = 1.0;
  options.prior = priorFrom(
      statedPoseOf(track_.prediction(is_velocity_doubted)), PriorFloor(), widening);
  PosteriorEstimate estimate =
      estimatePosterior(points, *target_points_, options.prior.mean, options, progress);
  Summary& summary = estimate.summary;
  doubtRounding(
      std::max(usualCoordinate(points), usualCoordinate(target_points_->points())),
      options,
      summary);
  step.status = toString(summary.status);
  step.message = summary.message;
  const DataFlags& flags = summary.data.flags;
  const PoseEstimate posterior(summary);
  std::string complaint = complaintAboutExport(posterior, true);
  if (complaint.empty() && flags.wrong_basin)
    complaint = "the pose may be in another basin";
  if (complaint.empty()) {
    const PoseMeasurement measurement =
        withoutPrior(posterior, Prior(options.prior.mean, options.prior.variance));
    complaint = complaintAboutExport(measurement.estimate, true);
    step.num_unmeasured = measurement.num_unmeasured;
    step.edge = {measurement.estimate.mean,
                 measurement.estimate.covariance(CovarianceConvention::RightSE3)};
  }
  if (!complaint.empty()) {
    step.message += "; not used: " + complaint;
    return attempt;
  }
  attempt.quality = Attempt::Good;
  step.kind = StepKind::Registered;
  if (summary.status == Status::Doubtful) {
    attempt.quality = flags.prior_conflict ? Attempt::Contradiction : Attempt::Doubtful;
    step.kind = StepKind::Widened;
    step.edge.covariance *= doubt_factor;
  }
  return attempt;
}

Tracker::Attempt
Tracker::registerTo(const Eigen::Matrix3Xd& points,
                    const ProgressCallback& progress) const
{
  const Attempt usual = registerTo(points, false, progress);
  const std::string cancelled = toString(Status::Cancelled);
  if (usual.quality == Attempt::Good || usual.step.status == cancelled)
    return usual;
  const Attempt open = registerTo(points, true, progress);
  if (open.step.status == cancelled)
    return open;
  // Of two that are as good, the one that trusts the motion before less.
  return open.quality != Attempt::Useless && open.quality >= usual.quality ? open
                                                                           : usual;
}

std::optional<TrackStep>
Tracker::registerNext(const ProgressCallback& progress)
{
  const auto start = std::chrono::steady_clock::now();
  Attempt attempt;
  attempt.step.status = "error";
  const int scan = track_.size();
  prepareTarget();
  try {
    const Eigen::Matrix3Xd points =
        io::readFinitePoints(request_.scans.at(static_cast<std::size_t>(scan)))
            .cast<double>();
    attempt = registerTo(points, progress);
    points_[scan] = points;
  }
  catch (const io::FileError& error) {
    attempt.step.message = error.what();
  }
  catch (const Refusal& refusal) {
    attempt.step.message = refusal.what();
  }
  TrackStep& step = attempt.step;
  if (step.status == toString(Status::Cancelled))
    return std::nullopt;
  step.scan = scan;
  step.target = track_.target();
  if (attempt.quality == Attempt::Useless) {
    const bool is_last = track_.numFailures() + 1 >= max_failures;
    step.kind =
        is_last && points_.count(scan) > 0 ? StepKind::Split : StepKind::Predicted;
    step.is_velocity_doubted = false;
    step.edge = track_.prediction(false);
    step.num_unmeasured = 6;
  }
  if (step.kind == StepKind::Predicted)
    points_.erase(scan);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  step.seconds = time.count();
  return step;
}

} // namespace bayesian_icp::app
