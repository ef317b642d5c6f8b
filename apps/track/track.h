/** \file
 * \brief What is known of a sequence of scans after some of them have been registered.
 */
#pragma once

#include "track/motion_filter.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace bayesian_icp::app {

/** \brief What became of a scan. */
enum class StepKind {
  /** Registered; status Ok. */
  Registered,
  /** Registered with status Doubtful: variances are multiplied by doubt_factor. */
  Widened,
  /** Not registered: its pose is what the motion before makes likely. */
  Predicted,
  /** As Predicted; but max_failures or more have failed in a row, and this scan can be
   * read, so that it becomes the target. */
  Split
};

/** \brief Short name: "registered", "widened", "predicted", "split". */
const char*
toString(StepKind kind);

/** \brief If so many scans in a row could not be registered, the last one that can be
 * read is the new target. */
constexpr int max_failures = 3;

/** \brief What the clouds say about two scans, without any prior. */
struct TrackEdge {
  /** The scan in whose frame the edge is. */
  int target = 0;
  /** The scan in the target's frame. */
  GaussianPose pose;
  /** Directions that the clouds do not see, 0 to 6. */
  int num_unmeasured = 6;
};

/** \brief One scan and its edges. Scans are numbered from 0. */
struct TrackStep {
  int scan = 0;
  StepKind kind = StepKind::Predicted;
  /** Whether the registration was not ok with the prediction as prior, so that the
   * velocity is taken to be as unknown as at first. */
  bool is_velocity_doubted = false;
  /** Short name of the registration's Status, and the status in words. */
  std::string status;
  std::string message;
  /** To the track's target; the prediction if the scan was not registered. */
  TrackEdge edge;
  /** To other scans before it, which the filter does not take. */
  std::vector<TrackEdge> more_edges;
  /** For reading the cloud and registering it. */
  double seconds = 0.0;
  /** TrackRequest::filesState() before it was read. */
  std::string files_state;
};

/** \brief The steps so far, and what follows from them. It never reads a cloud, so that
 * a track that was interrupted goes on from its steps. */
class Track {
public:
  /** \param[in] times of all scans [ns], increasing
   * \param[in] map_scans number of scans that make a target, at least 1 */
  Track(const MotionModel& model, std::vector<std::int64_t> times, int map_scans);

  /** \brief Number of scans that have a pose; scan 0 always has. */
  int
  size() const
  {
    return static_cast<int>(poses_.size());
  }

  /** \brief Where the next scan is likely to be in the target's frame.
   * \param[in] is_velocity_doubted as in TrackStep */
  GaussianPose
  prediction(bool is_velocity_doubted) const;

  /** \brief MotionFilter::keptInPlane() */
  Matrix6d
  keptInPlane(const Matrix6d& covariance) const
  {
    return filter_.keptInPlane(covariance);
  }

  /** \brief Go on to the next scan; \p step is about it. */
  void
  take(const TrackStep& step);

  /** \brief The scan in whose frame the target is. */
  int
  target() const
  {
    return target_;
  }

  /** \brief The scans of which the target consists, and their poses T_target_scan. */
  const std::vector<std::pair<int, Eigen::Matrix4d>>&
  targetScans() const
  {
    return target_scans_;
  }

  /** \brief How much scans of the target are out of place, on average, as a covariance
   * of poses T_target_scan: an edge to the target is at least as uncertain. 0 for one
   * scan. The errors of its scans are taken as independent.
   * \param[in] T_target_scan of the edge; the covariance is in its scan's frame */
  Matrix6d
  targetCovariance(const Eigen::Matrix4d& T_target_scan) const;

  /** \brief Scans in a row that could not be registered. */
  int
  numFailures() const
  {
    return num_failures_;
  }

  /** \brief All steps, from that of scan 1 on. */
  const std::vector<TrackStep>&
  steps() const
  {
    return steps_;
  }

  /** \brief Steps that are registered, but leave a motion to the prediction that the
   * model does not exclude. */
  std::size_t
  numUnmeasured() const;

  /** \brief Normalised innovation squared of each step; NaN if it was not registered.
   */
  const std::vector<double>&
  innovations() const
  {
    return innovations_;
  }

  /** \brief Poses in the frame of scan 0, each as it was known right after its step. */
  const std::vector<GaussianPose>&
  poses() const
  {
    return poses_;
  }

  /** \brief The edges of all steps, without the prior, in their order; those of
   * predicted and split steps are the prediction. */
  std::vector<GraphEdge>
  edges() const;

  /** \brief Times of all scans [ns]. */
  const std::vector<std::int64_t>&
  times() const
  {
    return times_;
  }

private:
  void
  predict(bool is_velocity_doubted, MotionFilter& filter) const;

  void
  changeTarget(StepKind kind);

  std::vector<std::int64_t> times_;
  int map_scans_;
  MotionFilter filter_;
  int target_ = 0;
  std::vector<std::pair<int, Eigen::Matrix4d>> target_scans_;
  /** Of twists on the left of T_target_scan. */
  Matrix6d target_covariance_ = Matrix6d::Zero();
  /** Scans that were registered to this target, and their poses in its frame. */
  std::vector<std::pair<int, GaussianPose>> registered_;
  int num_failures_ = 0;
  std::vector<TrackStep> steps_;
  std::vector<double> innovations_;
  std::vector<GaussianPose> poses_;
};

} // namespace bayesian_icp::app
