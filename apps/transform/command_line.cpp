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
  options.add_options()("help,h", "show this text");
  options.add_options()("version", "show the version");
  options.add_options()(
      "pose,p",
      text("POSE|FILE"),
      "the motion: x,y,z,roll,pitch,yaw [m, rad] with R = Rz(yaw) Ry(pitch) Rx(roll); "
      "a text file with the 4x4 matrix; or a posterior.json (a name that ends in "
      ".json), whose pose maps source points into the target frame");
  options.add_options()("use",
                        text("NAME"),
                        "of a posterior.json: final, the transformation that the "
                        "program decided on, or mean, the posterior's (default final)");
  options.add_options()("inverse", "apply the inverse motion");
  options.add_options()("overwrite", "OUTPUT may be INPUT");
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
    throw io::UsageError("two files are needed, the input and the output, not " +
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
  help
      << "Usage: pcl_bayesian_icp_transform INPUT OUTPUT --pose POSE|FILE [options]\n\n"
         "Moves a cloud, a .pcd or .ply file in metres: points are moved, normals and "
         "the\n"
         "viewpoint turned with them, all other fields kept. OUTPUT is a compressed "
         "PCD or\n"
         "a binary PLY, as its name says, and appears complete or not at all.\n\n"
      << describeOptions()
      << "\nExit codes:\n"
         "  0    done\n"
         "  1    out of memory\n"
         "  2    wrong usage\n"
         "  3    a file cannot be read, used or written\n"
         "  130  interrupted while writing (Ctrl-C or SIGTERM); it has been written\n"
         "\nExample:\n"
         "  pcl_bayesian_icp source.pcd target.pcd -o out\n"
         "  pcl_bayesian_icp_transform source.pcd moved.ply --pose "
         "out/posterior.json --use mean\n";
  return help.str();
}

} // namespace bayesian_icp::transform
