#include "viewer/option_descriptions.h"

#include "register/option_descriptions.h"
#include "register/settings.h"
#include "viewer/command_line.h"

#include <boost/program_options/value_semantic.hpp>

#include <sstream>
#include <vector>

namespace bayesian_icp::viewer {

namespace po = boost::program_options;

namespace {

po::typed_value<std::string>*
text(const char* placeholder)
{
  return po::value<std::string>()->value_name(placeholder);
}

po::typed_value<std::vector<std::string>>*
oncePerCloud(const char* placeholder)
{
  return po::value<std::vector<std::string>>()->composing()->value_name(placeholder);
}

po::options_description
describeGeneral()
{
  po::options_description group("General");
  group.add_options()("help,h", "Show this text.");
  group.add_options()("version", "Show the version.");
  group.add_options()("quiet", "Print errors only, and show no progress bar.");
  return group;
}

po::options_description
describePclViewers()
{
  po::options_description group(
      "As in pcl_viewer (give fc, ps and opaque for source, target, aligned)");
  group.add_options()(
      "bc", text("R,G,B"), "Background, each 0 to 1 or 0 to 255. (default 0,0,0)");
  group.add_options()(
      "fc", oncePerCloud("R,G,B"), "Colour of a cloud. (default depends on the cloud)");
  group.add_options()("ps", oncePerCloud("N"), "Point size, 1 to 64. (default 3)");
  group.add_options()("opaque", oncePerCloud("X"), "Opacity, 0 to 1. (default 1)");
  group.add_options()(
      "ax", text("X"), "Length of the target frame's axes [m]. (default 0: none)");
  group.add_options()(
      "cam",
      text("CAMERA"),
      "Initial view: what key c prints, or a .cam file. (default: all in sight, from "
      "the sensor if it is away from the target, else obliquely from above)");
  group.add_options()("multiview",
                      text("0|1"),
                      "Show four pictures: before, after, likely poses, deviations. "
                      "(default 0)");
  return group;
}

po::options_description
describeOwn()
{
  std::string layers = "Layers to show, separated by commas, or all: ";
  for (const LayerName& name : layer_names)
    layers += std::string(name.name) + ": " + name.help + "; ";
  layers += "(default target,deviation,position,rotation)";
  po::options_description group("Posterior");
  group.add_options()("show", text("LAYERS"), layers.c_str());
  group.add_options()(
      "draws",
      text("N"),
      "Number of draws to show, spread evenly over the chains. (default "
      "20)");
  group.add_options()(
      "magnify",
      text("X"),
      "Factor on the deviations from the mean in the layers draws, position and "
      "rotation. auto takes the largest of 1, 2, 5, 10, ... 1000 with which no "
      "standard deviation of a point exceeds a twentieth of the source. The picture "
      "states the factor. (default auto)");
  group.add_options()(
      "reference",
      text("POINT"),
      "Point whose position is shown: the source's centroid, or the origin of the "
      "source frame, to which the covariances of posterior.json refer. (default "
      "centroid)");
  group.add_options()("live",
                      "Show ICP's iterations and the chains while they run, then the "
                      "result. Without it, only the result is shown.");
  group.add_options()("screenshot",
                      text("FILE"),
                      "Write a PNG file instead of opening a window. With --live, it "
                      "shows the chains' last state.");
  group.add_options()(
      "size", text("WxH"), "Size of window or picture [pixels]. (default 1280x960)");
  return group;
}

} // namespace

po::options_description
describeOptions()
{
  po::options_description all;
  all.add(describeGeneral()).add(describePclViewers()).add(describeOwn());
  app::describeSettings(app::Settings(), all);
  return all;
}

std::string
keysText()
{
  std::ostringstream keys;
  keys << "Keys in addition to those of pcl_viewer (h lists all):\n";
  for (const LayerName& name : layer_names)
    keys << "  " << name.key << "    " << name.name << " on/off\n";
  keys << "  k    legend and colour bar on/off\n";
  return keys.str();
}

std::string
helpText()
{
  std::ostringstream help;
  help << R"(Usage: pcl_bayesian_icp_viewer SOURCE TARGET [options]
       pcl_bayesian_icp_viewer POSTERIOR.json [SOURCE TARGET] [options]

Registers a source cloud to a target cloud, or opens a result of
pcl_bayesian_icp -o (samples.csv is read from the folder of posterior.json).
Shows the posterior of the pose: how far off each point may be, and which poses
are likely. Clouds are .pcd or .ply files in metres. Everything is in the
target frame. Options begin with one or two dashes.
)" << describeOptions()
       << '\n'
       << keysText() << R"(
Exit codes:
  0    what was shown can be trusted
  1    it cannot (the status in the picture says why), or nothing could be
       shown, for example without an X display (xvfb-run provides one)
  2    wrong usage
  3    a file cannot be read, used or written
  130  interrupted (Ctrl-C or SIGTERM)

Example:
  pcl_bayesian_icp_viewer source.pcd target.pcd --live
  pcl_bayesian_icp_viewer result/posterior.json -multiview 1
  xvfb-run -a pcl_bayesian_icp_viewer result/posterior.json \
      --show target,deviation --screenshot deviation.png --size 800x600
)";
  return help.str();
}

} // namespace bayesian_icp::viewer
