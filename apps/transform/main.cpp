/** \file
 * \brief pcl_bayesian_icp_transform: moves a cloud by a pose that was found.
 */
#include "io/cloud_file.h"
#include "io/folders.h"
#include "io/interrupt.h"
#include "io/motion.h"
#include "io/output_folder.h"
#include "io/posterior_file.h"
#include "io/program.h"
#include "transform/command_line.h"

#include <Eigen/Geometry>

#include <filesystem>
#include <iostream>

namespace bayesian_icp::transform {
namespace {

namespace fs = std::filesystem;

Eigen::Matrix4d
motionOf(const Request& request)
{
  if (fs::path(request.pose).extension() != ".json")
    return io::readMotion("pose", request.pose);
  const io::PosteriorFile posterior = io::readPosterior(request.pose);
  Eigen::Matrix4d motion = request.choice == PoseChoice::Mean ? matrixOf(posterior.mean)
                                                              : posterior.final_matrix;
  const std::string complaint = io::complaintAboutMotion(motion);
  if (!complaint.empty())
    throw io::FileError(request.pose, complaint);
  return motion;
}

void
transformCloud(const Request& request)
{
  const io::CloudFormat format = io::formatOf(request.output_file);
  std::error_code ignored;
  if (!request.may_overwrite_input &&
      fs::equivalent(request.input_file, request.output_file, ignored))
    throw io::UsageError(request.output_file +
                         " is the input; use --overwrite to replace it");
  const Eigen::Affine3d motion(motionOf(request));
  const io::CloudFile cloud = io::readCloud(request.input_file);
  io::OutputFolder folder(io::folderOf(request.output_file));
  io::catchInterrupt(); // from here on a whole file or none
  const std::string name = fs::path(request.output_file).filename().string();
  folder.addByName(name, [&](const std::string& path) {
    const Eigen::Affine3d applied = request.is_inverse ? motion.inverse() : motion;
    io::writeCloud(io::movedCloud(cloud, applied.matrix()), format, path);
  });
  folder.commit();
}

int
runTool(int argc, char** argv)
{
  if (const auto request = parseCommandLine(argc, argv)) {
    io::silencePcl();
    transformCloud(*request);
  }
  return io::wasInterrupted() ? io::interrupted_exit_code : 0;
}

} // namespace
} // namespace bayesian_icp::transform

int
main(int argc, char** argv)
{
  using namespace bayesian_icp;
  return io::runProgram("pcl_bayesian_icp_transform",
                        [&] { return transform::runTool(argc, argv); });
}
