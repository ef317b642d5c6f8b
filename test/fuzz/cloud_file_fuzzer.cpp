/** \file
 * \brief Fuzzes clouds: reading .pcd and .ply files, moving the cloud, and writing it.
 */
#include "fuzz_input.h"
#include "io/cloud_file.h"
#include "io/errors.h"

#include <bayesian_icp/pose.h>

#include <sstream>
#include <stdexcept>

namespace {

using namespace bayesian_icp;

Eigen::Matrix4d
someMotion()
{
  return matrixOf({1.0, -2.0, 0.5, 0.1, -0.2, 3.0});
}

/** Equal, or both NaN. */
bool
areSame(const Eigen::Matrix3Xf& a, const Eigen::Matrix3Xf& b)
{
  return a.cols() == b.cols() &&
         ((a.array() == b.array()) || (a.array().isNaN() && b.array().isNaN())).all();
}

void
writeAndReadBack(const io::CloudFile& cloud, io::CloudFormat format)
{
  const bool is_pcd = format == io::CloudFormat::Pcd;
  const std::string path = fuzz::writeInput(is_pcd ? "out.pcd" : "out.ply", "");
  try {
    io::writeCloud(cloud, format, path);
  }
  catch (const std::runtime_error&) {
    return; // PCL does not know how, and has said so
  }
  fuzz::require(areSame(io::readCloud(path).points, cloud.points),
                "a cloud that was written is read back");
}

} // namespace

extern "C" int
LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/)
{
  io::silencePcl();
  return 0;
}

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  const std::string_view bytes = fuzz::textOf(data, size);
  const bool is_ply = bytes.substr(0, 3) == "ply";
  const std::string path = fuzz::writeInput(is_ply ? "in.ply" : "in.pcd", bytes);
  io::CloudFile cloud;
  if (!fuzz::isAccepted([&] { cloud = io::readCloud(path); }))
    return 0;
  const Eigen::Matrix3Xf finite = io::finitePoints(cloud);
  fuzz::require(finite.cols() >= 3 && finite.allFinite(),
                "three finite points at least");
  fuzz::require(finite.cwiseAbs().maxCoeff() == float(cloud.largest_coordinate),
                "the largest coordinate is that of a point");
  std::ostringstream stream;
  io::writeAligned(cloud, cloud, someMotion(), stream);
  const io::CloudFile moved = io::movedCloud(cloud, someMotion());
  if (moved.num_finite >= 3) { // not if they were moved out of the range of float
    writeAndReadBack(moved, io::CloudFormat::Pcd);
    writeAndReadBack(moved, io::CloudFormat::Ply);
  }
  return 0;
}
