#include "simulate/output.h"

#include "io/output_folder.h"
#include "simulate/record.h"

#include <pcl/io/pcd_io.h>
#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <nlohmann/json.hpp>

#include <iomanip>
#include <sstream>
#include <stdexcept>

namespace bayesian_icp::simulator {

namespace {

/** \brief Binary compressed, x, y, z only. */
void
writeCloud(const Eigen::Matrix3Xf& points, std::ostream& stream)
{
  pcl::PointCloud<pcl::PointXYZ> cloud;
  cloud.reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    cloud.push_back(pcl::PointXYZ(points(0, i), points(1, i), points(2, i)));
  pcl::PCLPointCloud2 blob;
  pcl::toPCLPointCloud2(cloud, blob);
  if (pcl::PCDWriter().writeBinaryCompressed(
          stream, blob, cloud.sensor_origin_, cloud.sensor_orientation_) < 0)
    throw std::runtime_error("PCL cannot write the cloud");
}

std::string
textOfMatrix(const Eigen::Matrix4d& matrix)
{
  std::ostringstream text;
  text << std::setprecision(17);
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      text << matrix(row, column) << (column < 3 ? ' ' : '\n');
  return text.str();
}

} // namespace

void
writePair(const std::string& folder,
          const SimulationOptions& options,
          const ScanPair& pair)
{
  io::OutputFolder files(folder);
  files.add("source.pcd",
            [&](std::ostream& stream) { writeCloud(pair.source, stream); });
  files.add("target.pcd",
            [&](std::ostream& stream) { writeCloud(pair.target, stream); });
  files.add("T_target_source.txt", [&](std::ostream& stream) {
    stream << textOfMatrix(pair.T_target_source);
  });
  files.add("scene.json", [&](std::ostream& stream) {
    stream << recordOf(options, pair).dump(2) << '\n';
  });
  files.commit();
}

} // namespace bayesian_icp::simulator
