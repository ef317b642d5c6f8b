#include "transform/command_line.h"

#include "io/command_line.h"

#include <sstream>
#include <vector>

namespace bayesian_icp::transform {

namespace po = boost::program_options;

namespace {

void
takeChoice(const std::string& name, PoseChoice& choice)
{
  if (name != "final" && name != "mean")
    io::refuseValue(name, "final or mean");
  choice = name == "mean" ? PoseChoice::Mean : PoseChoice::Final;
}

po::options_description
describeOptions(Request& request)
{
  const auto choice = [&request](const std::string& name) {
    takeChoice(name, request.choice);
  };
  po::options_description options("Options");
  // clang-format off
  options.add_options()
    ("help,h", "Show this text.")
    ("version", "Show the version.")
    ("pose,p", io::text("POSE|FILE", request.pose),
     "Motion to apply: x,y,z,roll,pitch,yaw [m, rad] with R = Rz(yaw) Ry(pitch) "
     "Rx(roll); a text file with the 4x4 matrix; or a posterior.json (a name that ends "
     "in .json), whose pose maps source points into the target frame. (required)")
    ("use", io::taken("NAME", choice),
     "Pose to take from a posterior.json: final is the program's final transformation, "
     "mean is the posterior mean. (default final)")
    ("inverse", io::flag(request.is_inverse),
     "Apply the inverse motion. Without it, the motion is applied.")
    ("overwrite", io::flag(request.may_overwrite_input),
     "Let OUTPUT replace INPUT. Without it, that is an error.");
  // clang-format on
  return options;
}

std::string
helpText(const po::options_description& options)
{
  std::ostringstream help;
  help << R"(Usage: pcl_bayesian_icp_transform INPUT OUTPUT --pose POSE|FILE [options]

Moves a cloud, a .pcd or .ply file in metres. It moves points and viewpoint,
rotates normals, and keeps all other fields. The name of OUTPUT decides the
format: a compressed PCD or a binary PLY. OUTPUT is complete, or there is none.

)" << options
       << R"(
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
)";
  return help.str();
}

} // namespace

std::optional<Request>
parseCommandLine(int argc, const char* const* argv)
{
  Request request;
  const po::options_description options = describeOptions(request);
  const po::variables_map given = io::splitCommandLine(argc, argv, options, "cloud");
  if (io::printHelpOrVersion(given,
                             "pcl_bayesian_icp_transform " BAYESIAN_ICP_VERSION,
                             [&options] { return helpText(options); }))
    return std::nullopt;
  const std::vector<std::string> clouds = io::optionTexts(given, "cloud");
  if (clouds.size() != 2)
    throw io::UsageError("expected two files, the input and the output, but got " +
                         std::to_string(clouds.size()));
  request.input_file = clouds[0];
  request.output_file = clouds[1];
  if (given.count("pose") == 0)
    throw io::UsageError("--pose is missing");
  io::takeOptions(given, options);
  return request;
}

} // namespace bayesian_icp::transform
