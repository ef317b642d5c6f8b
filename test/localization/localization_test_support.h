// Shared by the tests of localization: messages with the fields of ROS's, and the table
// of data/ as a map and a cloud.
#pragma once

#include "io/cloud_file.h"
#include "io/motion.h"
#include "localization/localizer.h"
#include "localization/messages.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace bayesian_icp::test {

struct Stamp {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};
struct Header {
  Stamp stamp;
  std::string frame_id;
};
struct Pose {
  struct {
    double x, y, z;
  } position;
  struct {
    double x, y, z, w;
  } orientation;
};
struct PoseWithCovarianceStamped {
  Header header;
  struct {
    Pose pose;
    std::array<double, 36> covariance;
  } pose;
};
struct PoseArray {
  Header header;
  std::vector<Pose> poses;
};
struct KeyValue {
  std::string key, value;
};
struct DiagnosticStatus {
  std::int8_t level;
  std::string name, message, hardware_id;
  std::vector<KeyValue> values;
};
struct DiagnosticArray {
  Header header;
  std::vector<DiagnosticStatus> status;
};

constexpr std::int64_t second = 1000000000;

/** A cloud of data/table in a frame. */
inline pcl::PCLPointCloud2::Ptr
tableCloud(const std::string& name, const std::string& frame)
{
  const auto cloud = pcl::make_shared<pcl::PCLPointCloud2>(
      *io::readCloud(BAYESIAN_ICP_DATA_DIR "/table/" + name + ".pcd").blob);
  cloud->header.frame_id = frame;
  return cloud;
}

inline Eigen::Matrix4d
trueTablePose()
{
  return io::readMatrixFile(BAYESIAN_ICP_DATA_DIR "/table/T_target_source.txt");
}

/** The pose with independent errors along and about the map's axes. */
inline app::StatedPose
statedPose(const Eigen::Matrix4d& pose, double deviation, std::int64_t stamp_ns)
{
  app::StatedPose stated;
  stated.frame = "map";
  stated.stamp_ns = stamp_ns;
  stated.position = pose.topRightCorner<3, 1>();
  stated.orientation = Eigen::Matrix3d(pose.topLeftCorner<3, 3>());
  stated.covariance = deviation * deviation * Matrix6d::Identity();
  return stated;
}

} // namespace bayesian_icp::test
