#include "io/cloud_file.h"

#include "io/cloud_format.h"
#include "io/errors.h"
#include "io/field_triple.h"
#include "io/numbers.h"

#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/PCLPointCloud2.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <limits>
#include <new>
#include <stdexcept>

namespace bayesian_icp::io {

namespace {

using Blob = pcl::PCLPointCloud2;

/** PCL's own reader. */
void
readBlob(const std::string& name, CloudFormat format, Blob& blob, CloudFile& cloud)
{
  int result = -1;
  int version = 0;
  errno = 0;
  try {
    const auto read = [&](auto reader) {
      return reader.read(
          name, blob, cloud.sensor_origin, cloud.sensor_orientation, version);
    };
    result =
        format == CloudFormat::Pcd ? read(pcl::PCDReader()) : read(pcl::PLYReader());
  }
  catch (const std::bad_alloc&) {
    throw;
  }
  catch (const std::exception& error) {
    throw FileError(name, std::string("PCL cannot read it: ") + error.what());
  }
  if (result < 0 && errno == ENOMEM)
    throw std::bad_alloc();
  if (result < 0)
    throw FileError(name, "PCL cannot read it");
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

/** Whether all coordinates are the same; one that is not a number is another one. */
bool
areSame(const Eigen::Matrix3Xf& a, const Eigen::Matrix3Xf& b)
{
  return a.cols() == b.cols() &&
         ((a.array() == b.array()) || (a.array().isNaN() && b.array().isNaN())).all();
}

/** Calls a writer of PCL, which may throw exceptions of any type.
 * \param[in] write returns what the writer does: negative for an error */
template <typename Write>
void
requireWritten(const Write& write)
{
  std::string reason;
  try {
    if (write() >= 0)
      return;
  }
  catch (const std::bad_alloc&) {
    throw;
  }
  catch (const std::exception& error) {
    reason = std::string(": ") + error.what();
  }
  throw std::runtime_error("PCL cannot write the cloud" + reason);
}

/** PCL does not notice a full disk, and has fields that it does not write to PLY as its
 * header says. */
void
requireComplete(const CloudFile& cloud, CloudFormat format, const std::string& path)
{
  try {
    InputFile file = openInput(path);
    format == CloudFormat::Pcd ? checkPcd(file) : checkPly(file);
    if (format == CloudFormat::Pcd)
      return;
    CloudFile written;
    Blob blob;
    readBlob(path, format, blob, written);
    const FieldTriple xyz(blob, {"x", "y", "z"});
    if (blob.data.size() == std::size_t(blob.width) * blob.height * blob.point_step &&
        xyz.isComplete())
      copyPoints(blob, xyz, written);
    if (!areSame(written.points, cloud.points))
      throw FileError(path, "its points differ from those of the cloud");
  }
  catch (const FileError& error) {
    const std::string reason = std::string(error.what()).substr(path.size() + 2);
    throw std::runtime_error(
        "what PCL has written is not complete or cannot be read: " + reason +
        (format == CloudFormat::Ply ? "; a .pcd keeps all fields" : ""));
  }
}

/** As PCL writes it to PLY: colours as the three bytes that its header promises. */
Blob
blobForPly(Blob blob)
{
  for (pcl::PCLPointField& field : blob.fields)
    if (field.name == "rgb" && field.datatype == pcl::PCLPointField::UINT32)
      field.datatype = pcl::PCLPointField::FLOAT32;
  return blob;
}

void
moveViewpoint(const Eigen::Affine3d& move, CloudFile& cloud)
{
  const Eigen::Vector3d origin = cloud.sensor_origin.head<3>().cast<double>();
  cloud.sensor_origin.head<3>() = (move * origin).cast<float>();
  const Eigen::Quaterniond turned =
      Eigen::Quaterniond(move.linear()) * cloud.sensor_orientation.cast<double>();
  cloud.sensor_orientation = turned.normalized().cast<float>();
}

} // namespace

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

void
silencePcl()
{
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
}

CloudFile
readCloud(const std::string& name)
{
  InputFile file = openInput(name);
  const CloudFormat format = formatOf(name);
  const std::uint64_t num_points =
      format == CloudFormat::Pcd ? checkPcd(file) : checkPly(file);

  CloudFile cloud;
  cloud.file = name;
  const auto blob = std::make_shared<Blob>();
  readBlob(name, format, *blob, cloud);
  if (std::uint64_t(blob->width) * blob->height != num_points ||
      blob->data.size() != num_points * blob->point_step)
    throw FileError(name,
                    "PCL found a different number of points than its header states");
  const FieldTriple xyz(*blob, {"x", "y", "z"});
  if (!xyz.isComplete())
    throw FileError(name, "has no floating-point fields x, y and z");
  copyPoints(*blob, xyz, cloud);
  cloud.has_doubles = xyz.areDoubles();
  if (cloud.num_finite < 3)
    throw FileError(name,
                    cloud.num_finite == 0
                        ? "has no finite points"
                        : "has only " + std::to_string(cloud.num_finite) +
                              " finite points; three are needed");
  cloud.blob = blob;
  return cloud;
}

std::string
noteOfLostDigits(const CloudFile& cloud)
{
  constexpr double noticeable = 1e-3;
  const auto largest = static_cast<float>(cloud.largest_coordinate);
  const double resolution =
      double(std::nextafter(largest, std::numeric_limits<float>::infinity())) - largest;
  if (!(resolution > noticeable))
    return "";
  return cloud.file + ": note: coordinates of up to " +
         textOf(cloud.largest_coordinate, 4) + " m are kept to " +
         textOf(resolution, 2) + " m only; move the clouds towards the origin for more";
}

Eigen::Matrix3Xf
finitePoints(const CloudFile& cloud)
{
  Eigen::Matrix3Xf finite(3, static_cast<Eigen::Index>(cloud.num_finite));
  Eigen::Index column = 0;
  for (Eigen::Index i = 0; i < cloud.points.cols(); ++i)
    if (cloud.points.col(i).allFinite())
      finite.col(column++) = cloud.points.col(i);
  return finite;
}

Eigen::Matrix3Xf
readFinitePoints(const std::string& name)
{
  return finitePoints(readCloud(name));
}

CloudFile
movedCloud(const CloudFile& cloud, const Eigen::Matrix4d& motion)
{
  const Eigen::Affine3d move(motion);
  CloudFile result = cloud;
  const auto blob = std::make_shared<Blob>(*cloud.blob);
  const FieldTriple xyz(*blob, {"x", "y", "z"});
  const FieldTriple normal(*blob, {"normal_x", "normal_y", "normal_z"});
  const std::size_t num_points = std::size_t(blob->width) * blob->height;
  for (std::size_t i = 0; i < num_points; ++i) {
    const Eigen::Vector3d point = xyz.get(*blob, i);
    if (point.allFinite())
      xyz.set(*blob, i, move * point);
    if (!normal.isComplete())
      continue;
    const Eigen::Vector3d direction = normal.get(*blob, i);
    if (direction.allFinite())
      normal.set(*blob, i, move.linear() * direction);
  }
  result.num_finite = 0;
  result.largest_coordinate = 0.0;
  copyPoints(*blob, xyz, result);
  if (result.num_finite < cloud.num_finite)
    throw std::runtime_error("the motion takes points further than a float can say");
  moveViewpoint(move, result);
  result.blob = blob;
  return result;
}

void
writeAligned(const CloudFile& source,
             const CloudFile& target,
             const Eigen::Matrix4d& T_target_source,
             std::ostream& stream)
{
  const CloudFile aligned = movedCloud(source, T_target_source);
  requireWritten([&] {
    return pcl::PCDWriter().writeBinaryCompressed(
        stream, *aligned.blob, target.sensor_origin, target.sensor_orientation);
  });
}

void
writeCloud(const CloudFile& cloud, CloudFormat format, const std::string& path)
{
  const Eigen::Vector4f& origin = cloud.sensor_origin;
  const Eigen::Quaternionf& orientation = cloud.sensor_orientation;
  requireWritten([&] {
    return format == CloudFormat::Pcd
               ? pcl::PCDWriter().writeBinaryCompressed(
                     path, *cloud.blob, origin, orientation)
               : pcl::PLYWriter().writeBinary(
                     path, blobForPly(*cloud.blob), origin, orientation);
  });
  requireComplete(cloud, format, path);
}

} // namespace bayesian_icp::io
