/** \file
 * \brief Point clouds from .pcd and .ply files, and an aligned one back.
 */
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <iosfwd>
#include <memory>
#include <string>

namespace pcl {
struct PCLPointCloud2;
}

namespace bayesian_icp::io {

/** \brief Keep PCL from printing: tools print what matters, once and with the file's
 * name. */
void
silencePcl();

/** \brief A cloud as it is in its file. */
struct CloudFile {
  std::string file;
  /** All fields of all points. */
  std::shared_ptr<const pcl::PCLPointCloud2> blob;
  /** Where the sensor stood [m] and how it was turned: PCD's VIEWPOINT. */
  Eigen::Vector4f sensor_origin = Eigen::Vector4f::Zero();
  Eigen::Quaternionf sensor_orientation = Eigen::Quaternionf::Identity();
  /** x, y, z [m], one point per column, including those that are not finite. */
  Eigen::Matrix3Xf points;
  std::size_t num_finite = 0;
  /** Largest |x|, |y|, |z| of the finite points [m]. */
  double largest_coordinate = 0.0;
  /** Whether \p blob has coordinates of 64 bits. */
  bool has_doubles = false;
};

/** \brief What coordinates of 32 bits lose where they are large, for the user; empty if
 * they are good to a millimetre. */
std::string
noteOfLostDigits(const CloudFile& cloud);

/** \brief Read a .pcd (any encoding) or .ply file. Coordinates may be of 32 or 64 bits.
 * \throws FileError if the file cannot be read or has fewer than three finite points */
CloudFile
readCloud(const std::string& name);

/** \brief The points of a cloud that are finite, in their order, 3 x n [m]. */
Eigen::Matrix3Xf
finitePoints(const CloudFile& cloud);

/** \brief As readCloud(), but the finite points alone. */
Eigen::Matrix3Xf
readFinitePoints(const std::string& name);

/** \brief The same cloud in another frame: x, y, z are moved and normal_x, normal_y,
 * normal_z turned where they are finite, and the viewpoint with them. All other fields
 * and the order of the points are kept. */
CloudFile
movedCloud(const CloudFile& cloud, const Eigen::Matrix4d& motion);

/** \brief Write \p source, moved into the frame of \p target, as a compressed PCD.
 *
 * As movedCloud(), but the viewpoint is the target's, so that viewers, which apply it,
 * put both clouds in one place.
 * \throws std::runtime_error if it cannot be encoded */
void
writeAligned(const CloudFile& source,
             const CloudFile& target,
             const Eigen::Matrix4d& T_target_source,
             std::ostream& stream);

enum class CloudFormat { Pcd, Ply };

/** \brief What the name of a file ends in, in capitals or not.
 * \throws FileError if it is neither .pcd nor .ply */
CloudFormat
formatOf(const std::string& name);

/** \brief Write a cloud as a compressed PCD or a binary PLY to the file \p path.
 * \throws std::runtime_error if it cannot be encoded or written */
void
writeCloud(const CloudFile& cloud, CloudFormat format, const std::string& path);

} // namespace bayesian_icp::io
