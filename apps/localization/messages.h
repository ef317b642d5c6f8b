/** \file
 * \brief Between messages of ROS 1 or ROS 2 and a Localizer: templates for any types
 * with the fields of the messages, as in bayesian_icp/ros_messages.h.
 */
#pragma once

#include "localization/localizer.h"

#include <bayesian_icp/ros_messages.h>

#include <cstdint>
#include <string>

namespace bayesian_icp::app {

/** \brief A stamp of ROS 2 [ns]. */
template <typename Stamp>
auto
nanosecondsOf(const Stamp& stamp) -> decltype(stamp.nanosec, std::int64_t())
{
  return std::int64_t(1000000000) * stamp.sec + stamp.nanosec;
}

/** \brief A stamp of ROS 1 [ns]. */
template <typename Stamp>
auto
nanosecondsOf(const Stamp& stamp) -> decltype(stamp.nsec, std::int64_t())
{
  return std::int64_t(1000000000) * stamp.sec + stamp.nsec;
}

/** \brief What a geometry_msgs/PoseWithCovarianceStamped says. */
template <typename PoseWithCovarianceStamped>
StatedPose
statedPoseOf(const PoseWithCovarianceStamped& message)
{
  StatedPose stated;
  stated.frame = message.header.frame_id;
  stated.stamp_ns = nanosecondsOf(message.header.stamp);
  const auto& position = message.pose.pose.position;
  const auto& orientation = message.pose.pose.orientation;
  stated.position << position.x, position.y, position.z;
  stated.orientation = {orientation.w, orientation.x, orientation.y, orientation.z};
  for (Eigen::Index i = 0; i < 36; ++i)
    stated.covariance(i / 6, i % 6) =
        message.pose.covariance[static_cast<std::size_t>(i)];
  return stated;
}

/** \brief Fill a geometry_msgs/PoseWithCovarianceStamped.
 * \param[in] header stamp and frame_id of the message
 * \param[in] estimate one of a Localization */
template <typename Header, typename PoseWithCovarianceStamped>
void
fillStampedPose(const Header& header,
                const PoseEstimate& estimate,
                PoseWithCovarianceStamped& message)
{
  message.header = header;
  fillPoseWithCovariance(estimate, ExportOptions(), message.pose);
}

/** \brief Fill a geometry_msgs/PoseArray with all draws. */
template <typename Header, typename PoseArray>
void
fillPoseArray(const Header& header, const PoseMatrix& draws, PoseArray& message)
{
  message.header = header;
  message.poses.resize(static_cast<std::size_t>(draws.rows()));
  for (Eigen::Index i = 0; i < draws.rows(); ++i)
    bayesian_icp::fillPose(Vector6d(draws.row(i).transpose()),
                           message.poses[static_cast<std::size_t>(i)]);
}

/** \brief Fill a diagnostic_msgs/DiagnosticArray with one status.
 * \param[in] name of the status; hardware_id is the cloud's frame, from \p header */
template <typename Header, typename DiagnosticArray>
void
fillDiagnostics(const Header& header,
                const std::string& name,
                const Localization& localization,
                DiagnosticArray& message)
{
  message.header = header;
  message.status.resize(1);
  auto& status = message.status[0];
  status.level = static_cast<decltype(status.level)>(localization.level);
  status.name = name;
  status.hardware_id = header.frame_id;
  status.message = localization.message;
  status.values.clear();
  for (const auto& [key, value] : localization.values) {
    status.values.emplace_back();
    status.values.back().key = key;
    status.values.back().value = value;
  }
}

} // namespace bayesian_icp::app
