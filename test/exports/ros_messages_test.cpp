// Messages of ROS are filled with the numbers of rosYaml(), in types with the fields of
// ROS 1, of ROS 2 and, where they are installed, in the real ones of ROS 1 and those
// that ROS 2's generator makes.
#include "exports/some_estimate.h"

#include <bayesian_icp/ros_messages.h>

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <string>

#ifdef BAYESIAN_ICP_TEST_ROS1
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Odometry.h>
#endif
#ifdef BAYESIAN_ICP_TEST_ROS2
#include <geometry_msgs/msg/pose_with_covariance_stamped.hpp>
#include <nav_msgs/msg/odometry.hpp>
#endif

using namespace bayesian_icp;
using namespace bayesian_icp::test;

namespace {

struct Stamp1 {
  std::uint32_t sec, nsec;
};
struct Stamp2 {
  std::int32_t sec;
  std::uint32_t nanosec;
};

struct Point {
  double x, y, z;
};
struct Quaternion {
  double x, y, z, w;
};
struct Pose {
  Point position;
  Quaternion orientation;
};
struct PoseWithCovariance {
  Pose pose;
  std::array<double, 36> covariance;
};

template <typename Stamp>
struct Header {
  Stamp stamp;
  std::string frame_id;
};

template <typename Stamp>
struct PoseWithCovarianceStampedOf {
  Header<Stamp> header;
  PoseWithCovariance pose;
};

template <typename Stamp>
struct OdometryOf {
  Header<Stamp> header;
  std::string child_frame_id;
  PoseWithCovariance pose;
  int twist = 17;
};

template <typename Stamp>
auto
nanosecondsOf(const Stamp& stamp) -> decltype(stamp.nanosec)
{
  return stamp.nanosec;
}

template <typename Stamp>
auto
nanosecondsOf(const Stamp& stamp) -> decltype(stamp.nsec)
{
  return stamp.nsec;
}

template <typename Stamp>
struct MessagesOf {
  using Stamped = PoseWithCovarianceStampedOf<Stamp>;
  using Odometry = OdometryOf<Stamp>;
};
struct LikeRos1 : MessagesOf<Stamp1> {
  static constexpr const char* name = "LikeRos1";
};
struct LikeRos2 : MessagesOf<Stamp2> {
  static constexpr const char* name = "LikeRos2";
};
#ifdef BAYESIAN_ICP_TEST_ROS1
struct Ros1 {
  using Stamped = geometry_msgs::PoseWithCovarianceStamped;
  using Odometry = nav_msgs::Odometry;
  static constexpr const char* name = "Ros1";
};
#endif
#ifdef BAYESIAN_ICP_TEST_ROS2
struct Ros2 {
  using Stamped = geometry_msgs::msg::PoseWithCovarianceStamped;
  using Odometry = nav_msgs::msg::Odometry;
  static constexpr const char* name = "Ros2";
};
#endif

template <typename Messages>
class RosMessages : public ::testing::Test {};

using MessageTypes = ::testing::Types<LikeRos1,
                                      LikeRos2
#ifdef BAYESIAN_ICP_TEST_ROS1
                                      ,
                                      Ros1
#endif
#ifdef BAYESIAN_ICP_TEST_ROS2
                                      ,
                                      Ros2
#endif
                                      >;

struct Names {
  template <typename Messages>
  static std::string
  GetName(int)
  {
    return Messages::name;
  }
};
TYPED_TEST_SUITE(RosMessages, MessageTypes, Names);

ExportOptions
someOptions()
{
  ExportOptions options;
  options.timestamp_ns = 1700000000250000000;
  options.target_frame = "map";
  options.source_frame = "scan";
  return options;
}

template <typename Message>
void
expectTheYaml(const Message& message, const PoseEstimate& estimate)
{
  const auto numbers = numbersOf(rosYaml(estimate, someOptions()));
  ASSERT_EQ(numbers.size(), 2U + 3U + 4U + 36U);
  EXPECT_EQ(message.header.stamp.sec, numbers[0]);
  EXPECT_EQ(nanosecondsOf(message.header.stamp), numbers[1]);
  EXPECT_EQ(message.header.frame_id, "map");
  const auto& pose = message.pose.pose;
  const std::array<double, 7> found = {pose.position.x,
                                       pose.position.y,
                                       pose.position.z,
                                       pose.orientation.x,
                                       pose.orientation.y,
                                       pose.orientation.z,
                                       pose.orientation.w};
  for (std::size_t i = 0; i < 7; ++i)
    EXPECT_NEAR(found[i], numbers[2 + i], 1e-15) << i;
  for (std::size_t i = 0; i < 36; ++i)
    EXPECT_EQ(message.pose.covariance[i], numbers[9 + i]) << i;
}

} // namespace

TYPED_TEST(RosMessages, HaveTheNumbersOfTheYaml)
{
  const PoseEstimate estimate = estimateOf(drawsAboutMean(0.1));
  typename TypeParam::Stamped stamped;
  fillPoseWithCovarianceStamped(estimate, someOptions(), stamped);
  expectTheYaml(stamped, estimate);

  typename TypeParam::Odometry odometry;
  const auto twist = odometry.twist;
  fillOdometry(estimate, someOptions(), odometry);
  expectTheYaml(odometry, estimate);
  EXPECT_EQ(odometry.child_frame_id, "scan");
  EXPECT_TRUE(odometry.twist == twist);
}

TYPED_TEST(RosMessages, AreNotFilledWithWhatIsNotExported)
{
  typename TypeParam::Odometry message;
  message.header.frame_id = message.child_frame_id = "before";
  message.pose.covariance[0] = 42.0;
  PoseEstimate estimate = estimateOf(drawsAboutMean(0.1));
  estimate.status = Status::NotMixed;
  EXPECT_THROW(fillOdometry(estimate, someOptions(), message), std::invalid_argument);
  ExportOptions bad = someOptions();
  bad.target_frame = "two words";
  estimate.status = Status::Ok;
  EXPECT_THROW(fillOdometry(estimate, bad, message), std::invalid_argument);
  estimate.covariances[1](0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(fillOdometry(estimate, someOptions(), message), std::invalid_argument);
  EXPECT_EQ(message.header.frame_id, "before");
  EXPECT_EQ(message.child_frame_id, "before");
  EXPECT_EQ(message.pose.covariance[0], 42.0);
}

TYPED_TEST(RosMessages, OfUnreliablePosteriorsNeedToBeAskedFor)
{
  PoseEstimate estimate = estimateOf(drawsAboutMean(0.1));
  estimate.status = Status::NotMixed;
  ExportOptions options = someOptions();
  options.accept_unreliable = true;
  typename TypeParam::Stamped message;
  EXPECT_NO_THROW(fillPoseWithCovarianceStamped(estimate, options, message));
  EXPECT_EQ(message.header.frame_id, "map");
}

TEST(RosPose, HasAQuaternionWithoutNegativeW)
{
  for (const double yaw : {-3.0, -1.0, 0.0, 1.0, 3.0}) {
    Vector6d pose = meanPoseOfTests();
    pose[5] = yaw;
    Pose message;
    fillPose(pose, message);
    EXPECT_GE(message.orientation.w, 0.0);
  }
}
