/** \file
 * \brief A robot that moves with nearly constant velocity, seen by registrations.
 */
#pragma once

#include "graph/pose_graph.h"
#include "graph/sensor_plane.h"

#include <Eigen/Core>

#include <optional>

namespace bayesian_icp::app {

/** \brief What is known about the motion before the scans are seen. */
struct MotionModel {
  /** Twist in the scan's frame at the first scan [m/s, rad/s], and its covariance. */
  Vector6d velocity = Vector6d::Zero();
  Matrix6d velocity_covariance = Matrix6d::Zero();
  /** Standard deviations of the acceleration along and about each axis of the scan, one
   * draw for each interval between two scans but the first [m/s^2, rad/s^2]. It lasts
   * from the middle of the interval before to that of this one. */
  double acceleration = 1.0;
  double angular_acceleration = 1.0;
  /** Normal of the plane in which the sensor moves, in its frame: that of a 2-D laser
   * scanner's scans, which do not show any other motion. None: it moves in space. */
  std::optional<Eigen::Vector3d> plane_normal;
};

/** \brief An extended Kalman filter whose state is the target's pose in the frame of
 * scan 0, the scan's pose in the target's frame, and the scan's velocity.
 *
 * The target is a former scan. Errors of the three parts are correlated, and the filter
 * knows how: a motion that no registration sees is as uncertain as the velocity that
 * was true when it was last seen. Each error is one of the right, T = T_mean exp(xi),
 * to first order. */
class MotionFilter {
public:
  /** \brief Scan 0 is the target, and the scan too. */
  explicit MotionFilter(const MotionModel& model);

  /** \brief Forget the velocity: it is as uncertain as before the first scan, in
   * addition to what it is. */
  void
  doubtVelocity();

  /** \brief Go on to the next scan.
   * \param[in] seconds since the scan before, positive */
  void
  predict(double seconds);

  /** \brief Take in what a registration says without its prior. The update is
   * iterated (Bell and Cathey 1993): along a motion that the clouds hardly see, the
   * measurement may be far away, and a line to it would leave that motion.
   *
   * What all registrations have in common makes covariances wider and is not estimated
   * (a considered parameter, Schmidt 1966), because how it depends on the motion is not
   * known well enough. The noise of a scan is estimated: it cancels in part between the
   * registration of the scan and those to it.
   * \param[in] measured the scan in the target's frame
   * \param[in] shared of the registration's variance with others
   * \return normalised innovation squared: chi-square of as many degrees of freedom as
   *         the registration sees, if the model and both covariances are right */
  double
  update(const GaussianPose& measured, const SharedNoise& shared = SharedNoise());

  /** \brief Whether the model has a plane. */
  bool
  isInPlane() const
  {
    return model_.plane_normal.has_value();
  }

  /** \brief app::keptInPlane() with the model's plane. */
  Matrix6d
  keptInPlane(const Matrix6d& covariance) const
  {
    return app::keptInPlane(covariance, in_plane_);
  }

  /** \brief From now on the scan is the target. */
  void
  makeScanTheTarget();

  /** \brief The scan in the target's frame. */
  GaussianPose
  poseInTarget() const;

  /** \brief The scan in the frame of scan 0. */
  GaussianPose
  pose() const;

private:
  static constexpr int num_errors = 30 + num_common;
  using Errors = Eigen::Matrix<double, num_errors, 1>;
  using State = Eigen::Matrix<double, num_errors, num_errors>;

  template <typename Multiply>
  void
  propagate(const Multiply& multiply);

  MotionModel model_;
  /** The part of a twist that is in the model's plane. */
  Matrix6d in_plane_;
  /** The interval before the last scan, 0 before there is one. */
  double last_seconds_ = 0.0;
  Eigen::Matrix4d target_ = Eigen::Matrix4d::Identity();
  Eigen::Matrix4d scan_in_target_ = Eigen::Matrix4d::Identity();
  Vector6d velocity_;
  /** Expected noises, in units of their standard deviations. */
  Vector6d target_noise_ = Vector6d::Zero(), scan_noise_ = Vector6d::Zero();
  /** Of the errors of target_, scan_in_target_ and velocity_, and of the noises of the
   * target, of the scan and, in six columns, of all registrations (GraphEdge::shared).
   */
  State covariance_ = State::Zero();
};

} // namespace bayesian_icp::app
