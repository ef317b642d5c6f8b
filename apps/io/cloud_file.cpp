#include "io/cloud_file.h"

#include "io/cloud_format.h"
#include "io/errors.h"
#include "io/field_triple.h"

#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/PCLPointCloud2.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <stdexcept>

namespace bayesian_icp::io {

namespace {

using Blob = pcl::PCLPointCloud2;

enum class CloudFormat { Pcd, Ply };

CloudFormat
formatOf(const std::string& name)
{
  std::string extension = std::filesystem::path(name).extension().string();
  for (char& letter : extension)
    letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  if (extension == ".pcd")
    return CloudFormat::Pcd;
  if (extension == ".ply")
    return CloudFormat::Ply;
  throw FileError(name, "is neither .pcd nor .ply");
}

/** PCL's own reader. */
void
readBlob(const std::string& name, CloudFormat format, Blob& blob, CloudFile& cloud)
{
  int result = -1;
  int version = 0;
  Eigen::Quaternionf orientation = Eigen::Quaternionf::Identity();
  try {
    if (format == CloudFormat::Pcd)
      result =
          pcl::PCDReader().read(name, blob, cloud.sensor_origin, orientation, version);
    else
      result =
          pcl::PLYReader().read(name, blob, cloud.sensor_origin, orientation, version);
  }
  catch (const std::exception& error) {
    throw FileError(name, std::string("PCL cannot read it: ") + error.what());
  }
  if (result < 0)
    throw FileError(name, "PCL cannot read it");
  cloud.sensor_orientation = {
      orientation.w(), orientation.x(), orientation.y(), orientation.z()};
}

void
copyPoints(const Blob& blob, const FieldTriple& xyz, CloudFile& cloud)
{
  const std::size_t num_points = std::size_t(blob.width) * blob.height;
  cloud.points.resize(3, static_cast<Eigen::Index>(num_points));
  for (std::size_t i = 0; i < num_points; ++i) {
    const Eigen::Vector3f point = xyz.get(blob, i).cast<float>();
    cloud.points.col(static_cast<Eigen::Index>(i)) = point;
    if (!point.allFinite())
      continue;
    ++cloud.num_finite;
    cloud.largest_coordinate =
        std::max(cloud.largest_coordinate, double(point.cwiseAbs().maxCoeff()));
  }
}

} // namespace

void
silencePcl()
{
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
}

CloudFile
readCloud(const std::string& name)
{
  const CloudFormat format = formatOf(name);
  InputFile file = openInput(name);
  const std::uint64_t num_points =
      format == CloudFormat::Pcd ? checkPcd(file) : checkPly(file);

  CloudFile cloud;
  cloud.file = name;
  const auto blob = std::make_shared<Blob>();
  readBlob(name, format, *blob, cloud);
  if (std::uint64_t(blob->width) * blob->height != num_points ||
      blob->data.size() != num_points * blob->point_step)
    throw FileError(name, "PCL found another number of points than its header has");
  const FieldTriple xyz = findFields(*blob, {"x", "y", "z"});
  if (!xyz.isComplete())
    throw FileError(name, "has no floating-point fields x, y and z");
  copyPoints(*blob, xyz, cloud);
  if (cloud.num_finite < 3)
    throw FileError(name,
                    cloud.num_finite == 0
                        ? "has no finite points"
                        : "has only " + std::to_string(cloud.num_finite) +
                              " finite points; three are needed");
  cloud.blob = blob;
  return cloud;
}

void
writeAligned(const CloudFile& source,
             const CloudFile& target,
             const Eigen::Matrix4d& T_target_source,
             std::ostream& stream)
{
  Blob aligned = *source.blob;
  const Eigen::Affine3d motion(T_target_source);
  const FieldTriple xyz = findFields(aligned, {"x", "y", "z"});
  const FieldTriple normal = findFields(aligned, {"normal_x", "normal_y", "normal_z"});
  const std::size_t num_points = std::size_t(aligned.width) * aligned.height;
  for (std::size_t i = 0; i < num_points; ++i) {
    const Eigen::Vector3d point = xyz.get(aligned, i);
    if (point.allFinite())
      xyz.set(aligned, i, motion * point);
    if (!normal.isComplete())
      continue;
    const Eigen::Vector3d direction = normal.get(aligned, i);
    if (direction.allFinite())
      normal.set(aligned, i, motion.linear() * direction);
  }
  const Eigen::Vector4f& q = target.sensor_orientation;
  const int result = pcl::PCDWriter().writeBinaryCompressed(
      stream, aligned, target.sensor_origin, {q[0], q[1], q[2], q[3]});
  if (result < 0)
    throw std::runtime_error("PCL cannot write the aligned cloud");
}

} // namespace bayesian_icp::io
