/** \file
 * \brief pcl_bayesian_icp_transform: moves a cloud by a pose that was found.
 */
#include "io/cloud_file.h"
#include "io/command_line.h"
#include "io/folders.h"
#include "io/interrupt.h"
#include "io/motion.h"
#include "io/output_folder.h"
#include "io/posterior_file.h"
#include "io/program.h"

#include <bayesian_icp/exports.h>
#include <bayesian_icp/pose.h>
#include <bayesian_icp/summary.h>

#include <Eigen/Geometry>

#include <filesystem>
#include <string>
#include <vector>

namespace bayesian_icp::transform {
namespace {

namespace fs = std::filesystem;
namespace po = boost::program_options;

/** What the user asks for. */
struct Request {
  std::string input_file;
  std::string output_file;
  /** Six numbers, or the name of a matrix file or of a posterior.json. */
  std::string pose;
  /** The mean of a posterior.json, not its final transformation. */
  bool use_mean = false;
  bool is_inverse = false;
  bool may_overwrite_input = false;
};

po::options_description
describeOptions(Request& request)
{
  po::options_description options = io::generalOptions();
  // clang-format off
  options.add_options()
    ("pose,p", io::text("POSE|FILE", request.pose),
     "Motion to apply: x,y,z,roll,pitch,yaw [m, rad] with R = Rz(yaw) Ry(pitch) "
     "Rx(roll); a text file with the 4x4 matrix; or a posterior.json (a name that ends "
     "in .json), whose pose maps source points into the target frame. (required)")
    ("use", io::taken("NAME", [&request](const std::string& name) {
       if (name != "final" && name != "mean")
         io::refuseValue(name, "final or mean");
       request.use_mean = name == "mean";
     }),
     "Pose to take from a posterior.json: final is the program's final transformation, "
     "mean is the posterior mean. (default final)")
    ("inverse", io::flag(request.is_inverse),
     "Apply the inverse motion. Without it, the motion is applied.")
    ("overwrite", io::flag(request.may_overwrite_input),
     "Let OUTPUT replace INPUT. Without it, that is an error.");
  // clang-format on
  return options;
}

const io::ToolText tool_text = {
    "pcl_bayesian_icp_transform " BAYESIAN_ICP_VERSION,
    R"(Usage: pcl_bayesian_icp_transform INPUT OUTPUT --pose POSE|FILE [options]

Moves a cloud, a .pcd or .ply file in metres. It moves points and viewpoint,
rotates normals, and keeps all other fields. The name of OUTPUT decides the
format: a compressed PCD or a binary PLY. OUTPUT is complete, or there is none.

)",
    R"(
Exit codes:
  0    done
  1    out of memory
  2    wrong usage
  3    a file cannot be read, used or written
  130  interrupted while writing (Ctrl-C or SIGTERM); OUTPUT has been written

Example:
  pcl_bayesian_icp source.pcd target.pcd -o out
  pcl_bayesian_icp_transform source.pcd moved.ply --pose out/posterior.json \
      --use mean
)"};

/** As io::readCommandLine(). */
Request
parseCommandLine(int argc, const char* const* argv)
{
  Request request;
  const po::options_description options = describeOptions(request);
  const po::variables_map given =
      io::readCommandLine(argc, argv, options, "cloud", tool_text);
  const std::vector<std::string> clouds = io::optionTexts(given, "cloud");
  if (clouds.size() != 2)
    throw io::UsageError("expected two files, the input and the output, but got " +
                         std::to_string(clouds.size()));
  request.input_file = clouds[0];
  request.output_file = clouds[1];
  if (given.count("pose") == 0)
    throw io::UsageError("--pose is missing");
  io::takeOptions(given, options);
  if (given.count("use") > 0 && fs::path(request.pose).extension() != ".json")
    throw io::UsageError("--use: has no effect unless --pose is a posterior.json");
  return request;
}

/** Of a posterior.json: its final transformation, or its mean. */
Eigen::Matrix4d
motionOfPosterior(const Request& request)
{
  const io::PosteriorFile posterior = io::readPosterior(request.pose);
  Status status = Status::NotRun;
  readStatus(posterior.status, status);
  if (request.use_mean && !hasUsableMean(status))
    io::tell(request.pose + ": warning: the status is " + posterior.status +
             ", so the mean may be far from any pose that the clouds allow");
  const Eigen::Matrix4d motion =
      request.use_mean ? matrixOf(posterior.mean) : posterior.final_matrix;
  const std::string complaint = io::complaintAboutMotion(motion);
  if (!complaint.empty())
    throw io::FileError(request.pose, complaint);
  return motion;
}

Eigen::Matrix4d
motionOf(const Request& request)
{
  if (fs::path(request.pose).extension() == ".json")
    return motionOfPosterior(request);
  // A matrix with few digits would stretch the cloud: the nearest rotation.
  return matrixOf(poseOf(io::readMotion("pose", request.pose)));
}

void
transformCloud(const Request& request)
{
  const io::CloudFormat format = io::formatOf(request.output_file);
  if (!request.may_overwrite_input &&
      io::isSameFile(request.input_file, request.output_file))
    throw io::UsageError(request.output_file +
                         " is the input; use --overwrite to replace it");
  const Eigen::Affine3d motion(motionOf(request));
  const io::CloudFile cloud = io::readCloud(request.input_file);
  io::OutputFolder folder(io::folderOf(request.output_file));
  io::catchInterrupt(); // from here on a whole file or none
  const std::string name = fs::path(request.output_file).filename().string();
  std::string note;
  folder.addByName(name, [&](const std::string& path) {
    const Eigen::Affine3d applied = request.is_inverse ? motion.inverse() : motion;
    io::CloudFile moved = io::movedCloud(cloud, applied.matrix());
    moved.file = request.output_file;
    io::writeCloud(moved, format, path);
    if (!moved.has_doubles)
      note = io::noteOfLostDigits(moved);
  });
  folder.commit();
  io::tell(note);
}

int
runTool(int argc, char** argv)
{
  io::silencePcl();
  transformCloud(parseCommandLine(argc, argv));
  return io::wasInterrupted() ? io::Interrupted : io::Good;
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
