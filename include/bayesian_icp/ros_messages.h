/** \file
 * \brief Fills messages of ROS 1 and ROS 2 without depending on either: templates for
 * any type with the fields of geometry_msgs/PoseWithCovarianceStamped or
 * nav_msgs/Odometry. docs/exports.md has an example.
 *
 * The conventions are those of rosYaml(). The pose is the posterior mean
 * T_target_source, the pose of the source frame in the target frame [m]; frame_id is
 * the target's. The covariance is CovarianceConvention::R3xSO3, row by row: translation
 * along the target's axes [m], then rotation about these fixed axes [rad].
 */
#pragma once

#include <bayesian_icp/exports.h>
#include <bayesian_icp/pose.h>

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace bayesian_icp {
namespace ros_messages_detail {

/** ROS 2 has nanosec, ROS 1 has nsec. */
template <typename Stamp>
auto
setNanoseconds(Stamp& stamp, std::int64_t ns, int) -> decltype(stamp.nanosec, void())
{
  stamp.nanosec = static_cast<decltype(stamp.nanosec)>(ns);
}

template <typename Stamp>
auto
setNanoseconds(Stamp& stamp, std::int64_t ns, long) -> decltype(stamp.nsec, void())
{
  stamp.nsec = static_cast<decltype(stamp.nsec)>(ns);
}

template <typename Header>
void
fillHeader(const ExportOptions& options, Header& header)
{
  constexpr std::int64_t ns_per_s = 1000000000;
  auto& stamp = header.stamp;
  stamp.sec = static_cast<decltype(stamp.sec)>(options.timestamp_ns / ns_per_s);
  setNanoseconds(stamp, options.timestamp_ns % ns_per_s, 0);
  header.frame_id = options.target_frame;
}

/** \throws std::invalid_argument with the reason */
inline void
require(const PoseEstimate& estimate, const ExportOptions& options)
{
  std::string complaint =
      complaintAboutExport(estimate, false, options.accept_unreliable);
  if (complaint.empty())
    complaint = options.validate();
  if (!complaint.empty())
    throw std::invalid_argument(complaint);
}

} // namespace ros_messages_detail

/** \brief Fill a geometry_msgs/Pose, or a type with its fields.
 * \param[in] pose T_target_source (x, y, z, roll, pitch, yaw) [m, rad]
 * \param[out] message its quaternion has w >= 0 */
template <typename Pose>
void
fillPose(const Vector6d& pose, Pose& message)
{
  Eigen::Quaterniond rotation(rotationOf(pose));
  rotation.normalize();
  if (rotation.w() < 0.0)
    rotation.coeffs() *= -1.0;
  message.position.x = pose[0];
  message.position.y = pose[1];
  message.position.z = pose[2];
  message.orientation.x = rotation.x();
  message.orientation.y = rotation.y();
  message.orientation.z = rotation.z();
  message.orientation.w = rotation.w();
}

/** \brief Fill a geometry_msgs/PoseWithCovariance, or a type with its fields.
 * \param[in] estimate to be sent
 * \param[in] options accept_unreliable
 * \param[out] message unchanged if this throws
 * \throws std::invalid_argument with complaintAboutExport() or options.validate() */
template <typename PoseWithCovariance>
void
fillPoseWithCovariance(const PoseEstimate& estimate,
                       const ExportOptions& options,
                       PoseWithCovariance& message)
{
  ros_messages_detail::require(estimate, options);
  fillPose(estimate.mean, message.pose);
  const Matrix6d& covariance = estimate.covariance(CovarianceConvention::R3xSO3);
  for (Eigen::Index i = 0; i < 36; ++i)
    message.covariance[static_cast<std::size_t>(i)] = covariance(i / 6, i % 6);
}

/** \brief Fill a geometry_msgs/PoseWithCovarianceStamped, or a type with its fields:
 * stamp and frame_id from \p options, pose and covariance.
 * \throws std::invalid_argument as fillPoseWithCovariance(); nothing is filled then */
template <typename PoseWithCovarianceStamped>
void
fillPoseWithCovarianceStamped(const PoseEstimate& estimate,
                              const ExportOptions& options,
                              PoseWithCovarianceStamped& message)
{
  fillPoseWithCovariance(estimate, options, message.pose);
  ros_messages_detail::fillHeader(options, message.header);
}

/** \brief Fill the pose of a nav_msgs/Odometry, or of a type with its fields: stamp,
 * frame_id (the target), child_frame_id (the source), pose and covariance. The twist is
 * left unchanged, because a registration does not determine velocities.
 * \throws std::invalid_argument as fillPoseWithCovariance(); nothing is filled then */
template <typename Odometry>
void
fillOdometry(const PoseEstimate& estimate,
             const ExportOptions& options,
             Odometry& message)
{
  fillPoseWithCovarianceStamped(estimate, options, message);
  message.child_frame_id = options.source_frame;
}

} // namespace bayesian_icp
