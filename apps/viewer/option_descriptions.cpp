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
  group.add_options()("help,h", "show this text");
  group.add_options()("version", "show the version");
  group.add_options()("quiet", "print nothing but errors, and no progress bar");
  return group;
}

po::options_description
describePclViewers()
{
  po::options_description group(
      "As pcl_viewer's; fc, ps and opaque once for each of source, target, aligned");
  group.add_options()(
      "bc", text("R,G,B"), "background, each 0 to 1 or 0 to 255 (default 0,0,0)");
  group.add_options()("fc", oncePerCloud("R,G,B"), "colour of a cloud");
  group.add_options()("ps", oncePerCloud("N"), "point size, 1 to 64 (default 3)");
  group.add_options()("opaque", oncePerCloud("X"), "opacity, 0 to 1 (default 1)");
  group.add_options()(
      "ax", text("X"), "show the target frame's axes, this long [m] (default 0: none)");
  group.add_options()(
      "cam",
      text("CAMERA"),
      "initial view: what key c prints, or a .cam file (default: all in sight, from "
      "the "
      "sensor if it stands apart from the target, else from obliquely above)");
  group.add_options()("multiview",
                      text("0|1"),
                      "four pictures: before, after, likely poses, deviations (default "
                      "0)");
  return group;
}

po::options_description
describeOwn()
{
  std::string layers = "what to show, with commas between, or all: ";
  for (const LayerName& name : layer_names)
    layers += std::string(name.name) + ", " + name.help + "; ";
  layers += "(default target,deviation,position,rotation)";
  po::options_description group("Posterior");
  group.add_options()("show", text("LAYERS"), layers.c_str());
  group.add_options()(
      "draws", text("N"), "number of draws shown, evenly over the chains (default 20)");
  group.add_options()(
      "magnify",
      text("X"),
      "draw deviations from the mean so many times larger in draws, position and "
      "rotation, or auto: as large as 1, 2, 5, 10, ... 1000 can make the largest "
      "standard deviation of a point without exceeding a twentieth of the source "
      "(default auto); the picture says so");
  group.add_options()(
      "reference",
      text("POINT"),
      "whose position is shown: the source's centroid or the origin of its frame, to "
      "which the covariance in posterior.json belongs (default centroid)");
  group.add_options()(
      "live", "show ICP's iterations and the chains while they run, then the result");
  group.add_options()("screenshot",
                      text("FILE"),
                      "write a PNG file in place of opening a window; with --live of "
                      "the chains' last state");
  group.add_options()(
      "size", text("WxH"), "of window or picture in pixels (default 1280x960)");
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
  keys << "Keys beside pcl_viewer's (h lists those, too):\n";
  for (const LayerName& name : layer_names)
    keys << "  " << name.key << "    " << name.name << " on/off\n";
  keys << "  k    legend and colour bar on/off\n";
  return keys.str();
}

std::string
helpText()
{
  std::ostringstream help;
  help
      << "Usage: pcl_bayesian_icp_viewer SOURCE TARGET [options]\n"
         "       pcl_bayesian_icp_viewer POSTERIOR.json [SOURCE TARGET] [options]\n\n"
         "Registers a cloud to another, or opens what pcl_bayesian_icp -o has written\n"
         "(samples.csv is read from beside posterior.json), and shows the posterior "
         "of\n"
         "the pose: which points may be how far off, and which poses are likely.\n"
         "Clouds are .pcd or .ply files in metres; everything is in the target frame.\n"
         "Options may begin with one dash or two.\n"
      << describeOptions() << '\n'
      << keysText()
      << "\nExit codes:\n"
         "  0    what was shown can be trusted\n"
         "  1    it cannot (the status in the picture says why), or nothing could be\n"
         "       shown, for example without an X display (xvfb-run gives one)\n"
         "  2    wrong usage\n"
         "  3    a file cannot be read, used or written\n"
         "  130  interrupted (Ctrl-C or SIGTERM)\n"
         "\nExample:\n"
         "  pcl_bayesian_icp_viewer source.pcd target.pcd --live\n"
         "  pcl_bayesian_icp_viewer result/posterior.json -multiview 1\n"
         "  xvfb-run -a pcl_bayesian_icp_viewer result/posterior.json \\\n"
         "      --show target,deviation --screenshot deviation.png --size 800x600\n";
  return help.str();
}

} // namespace bayesian_icp::viewer
