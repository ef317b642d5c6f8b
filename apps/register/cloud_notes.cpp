#include "register/cloud_notes.h"

#include "io/errors.h"
#include "io/numbers.h"
#include "io/program.h"

#include <cmath>

namespace bayesian_icp::app {

std::string
noteOfSize(const io::CloudFile& cloud, const Settings& settings)
{
  constexpr double implausible = 500.0; // [m]
  if (settings.options.prior.variance != PriorOptions().variance)
    return "";
  const Eigen::Matrix3Xd points = io::finitePoints(cloud).cast<double>();
  const Eigen::Vector3d centroid = points.rowwise().mean();
  const double radius =
      (points.colwise() - centroid).norm() / std::sqrt(double(points.cols()));
  if (radius <= implausible)
    return "";
  return cloud.file + ": note: the points are " + io::fixedTextOf(radius, 0) +
         " m from their centroid (root mean square), for which the default prior of "
         "0.35 m and 0.35 rad is hardly meant. If the clouds are in millimetres, scale "
         "them: pcl_transform_point_cloud IN OUT -scale 0.001,0.001,0.001. If they are "
         "in metres, state --prior-variance.";
}

std::string
noteOfZeros(const io::CloudFile& cloud)
{
  constexpr double noticeable = 0.01;
  const auto num_zeros = (cloud.points.array() == 0.0F).colwise().all().count();
  if (!(static_cast<double>(num_zeros) >
        noticeable * static_cast<double>(cloud.num_finite)))
    return "";
  return cloud.file + ": note: " + std::to_string(num_zeros) +
         " points are at 0 0 0, as returns without a range are. ICP pairs them with "
         "one another, which takes long and draws its result to no motion. Preset "
         "calibrated counts them as one point. Remove them, or set them to NaN.";
}

void
tellNotesOfFirst(const std::string& scan, const Settings& settings)
{
  try {
    const io::CloudFile cloud = io::readCloud(scan);
    for (const std::string& note :
         {io::noteOfLostDigits(cloud), noteOfZeros(cloud), noteOfSize(cloud, settings)})
      io::tell(note);
  }
  catch (const io::FileError&) { // said where it is registered
  }
}

} // namespace bayesian_icp::app
