#include "track/track.h"

#include "io/time_stamps.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <limits>

namespace bayesian_icp::app {

const char*
toString(StepKind kind)
{
  static constexpr std::array<const char*, 4> names = {
      "registered", "widened", "predicted", "split"};
  const auto index = static_cast<std::size_t>(kind);
  return index < names.size() ? names[index] : "unknown";
}

Track::Track(const MotionModel& model, std::vector<std::int64_t> times, int map_scans)
: times_(std::move(times))
, map_scans_(map_scans)
, filter_(model)
, target_scans_{{0, Eigen::Matrix4d::Identity()}}
, poses_(1)
{}

void
Track::predict(bool is_velocity_doubted, MotionFilter& filter) const
{
  if (is_velocity_doubted)
    filter.doubtVelocity();
  const auto k = poses_.size();
  filter.predict(io::secondsOf(times_.at(k) - times_.at(k - 1)));
}

GaussianPose
Track::prediction(bool is_velocity_doubted) const
{
  MotionFilter next = filter_;
  predict(is_velocity_doubted, next);
  return next.poseInTarget();
}

void
Track::take(const TrackStep& step)
{
  predict(step.is_velocity_doubted, filter_);
  const bool is_registered =
      step.kind == StepKind::Registered || step.kind == StepKind::Widened;
  innovations_.push_back(is_registered ? filter_.update(step.edge.pose)
                                       : std::numeric_limits<double>::quiet_NaN());
  num_failures_ = is_registered ? 0 : num_failures_ + 1;
  if (is_registered)
    registered_.emplace_back(step.scan, filter_.poseInTarget());
  steps_.push_back(step);
  poses_.push_back(filter_.pose());
  if (step.kind == StepKind::Split ||
      static_cast<int>(registered_.size()) == map_scans_)
    changeTarget(step.kind);
}

std::size_t
Track::numUnmeasured() const
{
  const int num_excluded = filter_.isInPlane() ? num_motions_out_of_plane : 0;
  return static_cast<std::size_t>(
      std::count_if(steps_.begin(), steps_.end(), [&](const TrackStep& step) {
        return step.kind <= StepKind::Widened &&
               step.edge.num_unmeasured > num_excluded;
      }));
}

std::vector<GraphEdge>
Track::edges() const
{
  std::vector<GraphEdge> all;
  const auto add = [&all](int scan, const TrackEdge& edge) {
    all.push_back({edge.target, scan, matrixOf(edge.pose.mean), edge.pose.covariance});
  };
  for (const TrackStep& step : steps_) {
    add(step.scan, step.edge);
    for (const TrackEdge& edge : step.more_edges)
      add(step.scan, edge);
  }
  return all;
}

Matrix6d
Track::targetCovariance(const Eigen::Matrix4d& T_target_scan) const
{
  const Matrix6d carry = adjointOf(T_target_scan.inverse());
  return carry * target_covariance_ * carry.transpose();
}

void
Track::changeTarget(StepKind kind)
{
  if (kind == StepKind::Split)
    registered_.assign(1, {size() - 1, filter_.poseInTarget()});
  const auto [target, of_target] = registered_.back();
  const Eigen::Matrix4d to_new_target = matrixOf(of_target.mean).inverse();
  target_ = target;
  target_scans_.clear();
  target_covariance_.setZero();
  for (const auto& [scan, pose] : registered_) {
    const Eigen::Matrix4d T_target_scan = to_new_target * matrixOf(pose.mean);
    target_scans_.emplace_back(scan, T_target_scan);
    if (scan == target)
      continue;
    // (T exp(a))^-1 S exp(b) = exp(-a) T^-1 S exp(b), and b is carried to the left.
    const Matrix6d carry = adjointOf(T_target_scan);
    target_covariance_ +=
        of_target.covariance + carry * pose.covariance * carry.transpose();
  }
  target_covariance_ /= static_cast<double>(registered_.size());
  registered_.clear();
  num_failures_ = 0;
  filter_.makeScanTheTarget();
}

} // namespace bayesian_icp::app
