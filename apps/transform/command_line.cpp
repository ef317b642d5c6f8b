#include "transform/command_line.h"

#include "io/command_line.h"
#include "io/errors.h"

#include <boost/program_options.hpp>

#include <sstream>
#include <vector>

namespace bayesian_icp::transform {

namespace po = boost::program_options;

namespace {

po::options_description
describeOptions()
{
  po::options_description options("Options");
  const auto text = [](const char* placeholder) {
    return po::value<std::string>()->value_name(placeholder);
  };
  options.add_options()("help,h", "Show this text.");
  options.add_options()("version", "Show the version.");
  options.add_options()("pose,p",
                        text("POSE|FILE"),
                        "Motion to apply: x,y,z,roll,pitch,yaw [m, rad] with R = "
                        "Rz(yaw) Ry(pitch) Rx(roll); a text file with the 4x4 matrix; "
                        "or a posterior.json (a name that ends in .json), whose pose "
                        "maps source points into the target frame. (required)");
  options.add_options()("use",
                        text("NAME"),
                        "Pose to take from a posterior.json: final is the program's "
                        "final transformation, mean is the posterior mean. (default "
                        "final)");
  options.add_options()("inverse",
                        "Apply the inverse motion. Without it, the motion is applied.");
  options.add_options()("overwrite",
                        "Let OUTPUT replace INPUT. Without it, that is an error.");
  return options;
}

void
takeChoice(const po::variables_map& given, Request& request)
{
  if (given.count("use") == 0)
    return;
  const auto name = given["use"].as<std::string>();
  if (name != "final" && name != "mean")
    throw io::UsageError("--use: " + io::quoted(name) + " is not final or mean");
  request.choice = name == "mean" ? PoseChoice::Mean : PoseChoice::Final;
}

} // namespace

Request
parseCommandLine(int argc, const char* const* argv)
{
  const po::variables_map given =
      io::splitCommandLine(argc, argv, describeOptions(), "cloud");
  Request request;
  if (given.count("help") > 0 || given.count("version") > 0) {
    request.kind =
        given.count("help") > 0 ? Request::Kind::ShowHelp : Request::Kind::ShowVersion;
    return request;
  }
  const std::vector<std::string> clouds = io::optionTexts(given, "cloud");
  if (clouds.size() != 2)
    throw io::UsageError("expected two files, the input and the output, but got " +
                         std::to_string(clouds.size()));
  request.input_file = clouds[0];
  request.output_file = clouds[1];
  if (given.count("pose") == 0)
    throw io::UsageError("--pose is missing");
  request.pose = given["pose"].as<std::string>();
  takeChoice(given, request);
  request.is_inverse = given.count("inverse") > 0;
  request.may_overwrite_input = given.count("overwrite") > 0;
  return request;
}

std::string
helpText()
{
  std::ostringstream help;
  help << R"(Usage: pcl_bayesian_icp_transform INPUT OUTPUT --pose POSE|FILE [options]

Moves a cloud, a .pcd or .ply file in metres. It moves points and viewpoint,
rotates normals, and keeps all other fields. The name of OUTPUT decides the
format: a compressed PCD or a binary PLY. OUTPUT is complete, or there is none.

)" << describeOptions()
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

} // namespace bayesian_icp::transform
