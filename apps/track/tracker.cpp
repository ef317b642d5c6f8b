#include "track/tracker.h"

#include "graph/sensor_plane.h"
#include "io/clocks.h"
#include "io/cloud_file.h"
#include "io/errors.h"
#include "io/input_file.h"
#include "io/time_stamps.h"
#include "localization/stated_pose.h"

#include <boost/functional/hash.hpp>

#include <algorithm>
#include <array>
#include <unordered_set>

namespace bayesian_icp::app {

namespace {

/** The first point of each cube of this width, in their order. */
Eigen::Matrix3Xd
thinned(const Eigen::Matrix3Xd& points, double voxel_size)
{
  using Voxel = std::array<double, 3>;
  std::unordered_set<Voxel, boost::hash<Voxel>> voxels;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d place = (points.col(i) / voxel_size).array().floor();
    if (voxels.insert({place.x(), place.y(), place.z()}).second)
      kept.push_back(i);
  }
  return points(Eigen::all, kept);
}

} // namespace

MotionModel
motionModelOf(const TrackRequest& request)
{
  const PriorOptions& prior = request.settings.options.prior;
  const double seconds = io::secondsOf(request.times.at(1) - request.times.at(0));
  MotionModel model;
  model.velocity =
      logSE3(prior.mean.allFinite() ? matrixOf(prior.mean) : request.settings.guess) /
      seconds;
  model.velocity_covariance = (prior.variance / (seconds * seconds)).asDiagonal();
  model.acceleration = request.acceleration;
  model.angular_acceleration = request.angular_acceleration;
  model.plane_normal =
      planeNormalOf(io::readFinitePoints(request.scans.front()).cast<double>());
  return model;
}

std::string
TrackRequest::filesState(int scan) const
{
  return io::stateOf({scans.front(), scans.at(static_cast<std::size_t>(scan))});
}

Tracker::Tracker(const TrackRequest& request, const Track& track)
: request_(request)
, track_(track)
{}

PreparedCloud
Tracker::preparedScan(int scan)
{
  auto found = prepared_.find(scan);
  if (found == prepared_.end())
    found = prepared_
                .emplace(scan,
                         io::readFinitePoints(
                             request_.scans.at(static_cast<std::size_t>(scan)))
                             .cast<double>())
                .first;
  return found->second;
}

PreparedCloud
Tracker::mapOfTarget()
{
  Eigen::Matrix3Xd map(3, 0), part;
  for (const auto& [scan, T_target_scan] : track_.targetScans()) {
    const auto found = thinned_.find(scan);
    movePoints(poseOf(T_target_scan),
               found != thinned_.end()
                   ? found->second
                   : thinned(preparedScan(scan).points(), request_.voxel_size),
               part);
    map.conservativeResize(3, map.cols() + part.cols());
    map.rightCols(part.cols()) = part;
  }
  return thinned(map, request_.voxel_size);
}

void
Tracker::prepareTarget()
{
  if (target_scan_ == track_.target())
    return;
  target_scan_ = track_.target();
  target_ = request_.voxel_size > 0.0 ? mapOfTarget() : preparedScan(target_scan_);
  thinned_.clear();
}

Registration
Tracker::registerToTarget(const PreparedCloud& source,
                          const ProgressCallback& progress,
                          bool& is_velocity_doubted) const
{
  const auto attempt = [&](bool is_doubted) {
    GaussianPose prediction = track_.prediction(is_doubted);
    prediction.covariance += track_.targetCovariance(matrixOf(prediction.mean));
    Options options = request_.settings.options;
    options.prior =
        priorFrom(statedPoseOf(prediction.mean, prediction.covariance)).options;
    Registration result = registered(source, *target_, options, progress);
    result.edge.pose.covariance +=
        track_.targetCovariance(matrixOf(result.edge.pose.mean));
    return result;
  };
  const Registration first = attempt(false);
  if (first.quality == Quality::Cancelled || first.quality == Quality::Good)
    return first;
  const Registration open = attempt(true);
  // Of two that are as good, the one that trusts the motion before less.
  is_velocity_doubted =
      open.quality != Quality::Useless && open.quality >= first.quality;
  return is_velocity_doubted || open.quality == Quality::Cancelled ? open : first;
}

bool
Tracker::registerToMore(const PreparedCloud& source,
                        const ProgressCallback& progress,
                        TrackStep& step)
{
  const auto poseIn0 = [this](int scan) {
    return matrixOf(track_.poses().at(static_cast<std::size_t>(scan)).mean);
  };
  const Eigen::Matrix4d pose = poseIn0(track_.target()) * matrixOf(step.edge.pose.mean);
  for (int other = track_.target() - 1;
       other >= std::max(0, track_.size() - request_.span);
       --other) {
    const bool has_pose =
        other == 0 || track_.steps().at(static_cast<std::size_t>(other - 1)).kind !=
                          StepKind::Predicted;
    if (!has_pose)
      continue;
    Options options = request_.settings.options;
    options.prior.mean = poseOf(poseIn0(other).inverse() * pose);
    options.prior.variance =
        track_.keptInPlane(options.prior.variance.asDiagonal()).diagonal();
    options.prior.frame = PriorFrame::Origin;
    Registration result = registered(source, preparedScan(other), options, progress);
    if (result.quality == Quality::Cancelled)
      return false;
    result.edge.target = other;
    if (result.quality != Quality::Useless)
      step.more_edges.push_back(result.edge);
  }
  return true;
}

std::optional<TrackStep>
Tracker::registerNext(const ProgressCallback& progress)
{
  const double start = io::wallSeconds();
  prepareTarget();
  prepared_.erase(prepared_.begin(),
                  prepared_.lower_bound(track_.size() - request_.span));
  TrackStep step;
  step.scan = track_.size();
  step.files_state = request_.filesState(step.scan);
  Registration result;
  result.status = "error";
  try {
    result =
        registerToTarget(preparedScan(step.scan), progress, step.is_velocity_doubted);
  }
  catch (const io::FileError& error) {
    result.message = error.what();
  }
  catch (const Refusal& refusal) {
    result.message = refusal.what();
  }
  if (result.quality == Quality::Cancelled)
    return std::nullopt;
  step.status = result.status;
  step.message = result.message;
  step.edge = result.edge;
  if (result.quality == Quality::Useless) {
    const bool is_last = track_.numFailures() + 1 >= max_failures;
    step.kind = is_last && prepared_.count(step.scan) > 0 ? StepKind::Split
                                                          : StepKind::Predicted;
    step.is_velocity_doubted = false;
    step.edge = {track_.target(), track_.prediction(false)};
  }
  else {
    step.kind =
        result.quality == Quality::Good ? StepKind::Registered : StepKind::Widened;
    step.edge.target = track_.target();
    if (!registerToMore(preparedScan(step.scan), progress, step))
      return std::nullopt;
  }
  if (step.kind != StepKind::Predicted && request_.voxel_size > 0.0)
    thinned_[step.scan] =
        thinned(preparedScan(step.scan).points(), request_.voxel_size);
  step.seconds = io::wallSeconds() - start;
  return step;
}

} // namespace bayesian_icp::app
