#include "viewer/command_line.h"

#include "io/command_line.h"
#include "register/settings_options.h"

#include <boost/algorithm/string/predicate.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <vector>

namespace bayesian_icp::viewer {

namespace po = boost::program_options;

namespace {

/** Reads a number from \p lowest to \p highest. */
template <typename Number>
auto
within(Number lowest, Number highest)
{
  return [=](std::string_view text, Number& value) {
    return io::readNumber(text, value) && value >= lowest && value <= highest;
  };
}

/** Reads one of two names. */
template <typename Value>
auto
oneOf(const char* first_name, Value first, const char* second_name, Value second)
{
  return [=](const std::string& text, Value& value) {
    value = text == first_name ? first : second;
    return text == first_name || text == second_name;
  };
}

/** "r,g,b" in 0 ... 1, or in 0 ... 255 if one of them is above 1. */
bool
readColor(const std::string& text, Color& color)
{
  const auto isPart = [](double part) { return part >= 0.0 && part <= 255.0; };
  if (!io::readNumbers(text, color) || !std::all_of(color.begin(), color.end(), isPart))
    return false;
  if (*std::max_element(color.begin(), color.end()) > 1.0)
    for (double& part : color)
      part /= 255.0;
  return true;
}

/** A positive number, or "auto", which is 0. */
bool
readMagnification(const std::string& text, double& factor)
{
  factor = 0.0;
  return text == "auto" ||
         (io::readNumber(text, factor) && std::isfinite(factor) && factor > 0.0);
}

bool
readSize(const std::string& text, ViewOptions& view)
{
  const auto items = io::splitAt('x', text);
  view.is_size_given = true;
  return items.size() == 2 && within(least_width, 8192)(items[0], view.width) &&
         within(least_height, 8192)(items[1], view.height);
}

/** Names of layers separated by commas, or "all". */
void
readLayers(const std::string& text, Layers& layers)
{
  layers.clear();
  std::string known;
  for (const LayerName& name : layer_names)
    known += std::string(name.name) + ", ";
  for (const std::string_view item : io::splitAt(',', text)) {
    const std::size_t size_before = layers.size();
    for (const LayerName& name : layer_names)
      if (item == name.name || item == "all")
        layers.insert(name.layer);
    if (layers.size() == size_before)
      io::refuseValue(std::string(item), "(another) one of " + known + "all");
  }
}

/** An option with a value that \p read reads if it is what is \p expected. */
template <typename Read, typename Value>
po::typed_value<std::string>*
value(const char* placeholder, const Read& read, Value& value, const char* expected)
{
  return io::taken(placeholder, [=, &value](const std::string& text) {
    if (!read(text, value))
      io::refuseValue(text, expected);
  });
}

/** The same of the styles of the clouds, given up to once for each. */
template <typename Read, typename Value>
po::typed_value<std::vector<std::string>>*
oncePerCloud(const char* placeholder,
             const Read& read,
             Value PointStyle::*value,
             ViewOptions& view,
             const char* expected)
{
  const auto take = [=, &view](const std::vector<std::string>& texts) {
    if (texts.size() > view.styles.size())
      throw io::BadValue(": given more than three times (source, target, aligned)");
    for (std::size_t i = 0; i < texts.size(); ++i)
      if (!read(texts[i], view.styles[i].*value))
        io::refuseValue(texts[i], expected);
  };
  return po::value<std::vector<std::string>>()
      ->composing()
      ->value_name(placeholder)
      ->notifier(take);
}

std::string
layersHelp()
{
  std::string help = "Layers to show, separated by commas, or all: ";
  for (const LayerName& name : layer_names)
    help += std::string(name.name) + ": " + name.help + "; ";
  return help + "(default target,deviation,position,rotation)";
}

po::options_description
describeOptions(Request& request)
{
  constexpr double largest = std::numeric_limits<double>::max();
  constexpr const char* color = "a colour r,g,b, each 0 to 1 or each 0 to 255";
  ViewOptions& view = request.view;
  po::options_description general = io::generalOptions();
  po::options_description pcl_viewers(
      "As in pcl_viewer (give fc, ps and opaque for source, target, aligned)");
  po::options_description own("Posterior");
  // clang-format off
  general.add_options()
    ("quiet", io::flag(request.is_quiet), "Print errors only, and show no progress bar.");
  pcl_viewers.add_options()
    ("bc", value("R,G,B", readColor, view.background, color),
     "Background, each 0 to 1 or 0 to 255. (default 0,0,0)")
    ("fc", oncePerCloud("R,G,B", readColor, &PointStyle::color, view, color),
     "Colour of a cloud. (default depends on the cloud)")
    ("ps", oncePerCloud("N", within(1, 64), &PointStyle::size, view, "a point size, 1 to 64"),
     "Point size, 1 to 64. (default 3; 2 for the target)")
    ("opaque", oncePerCloud("X", within(0.0, 1.0), &PointStyle::opacity, view, "an opacity, 0 to 1"),
     "Opacity, 0 to 1. (default 1)")
    ("ax", value("X", within(0.0, largest), view.axes_scale, "a length [m]"),
     "Length of the target frame's axes [m]. (default 0: none)")
    ("cam", io::fileName("CAMERA", view.camera),
     "Initial view: the text that key c prints, or a .cam file. (default: everything "
     "in view, from the sensor if it is away from the target, else obliquely from "
     "above)")
    ("multiview", value("0|1", oneOf("0", false, "1", true), view.is_multiview, "0 or 1"),
     "Show four pictures: before, after, likely poses, deviations. Excludes --show. "
     "(default 0)");
  own.add_options()
    ("show",
     io::taken("LAYERS",
               [&view](const std::string& text) { readLayers(text, view.layers); }),
     layersHelp().c_str())
    ("draws", value("N", within(1, 1000), view.num_draws, "a number of draws, 1 to 1000"),
     "Number of draws to show, spread evenly over the chains. (default 20)")
    ("magnify",
     value("X", readMagnification, view.magnification, "a positive number or auto"),
     "Factor on the deviations from the mean in the layers draws, position and "
     "rotation. auto takes the largest of 1, 2, 5, 10, ... 1000 with which no standard "
     "deviation of a point exceeds a twentieth of the source. The picture states the "
     "factor. (default auto)")
    ("reference",
     value("POINT",
           oneOf("centroid", Reference::Centroid, "origin", Reference::Origin),
           view.reference,
           "centroid or origin"),
     "Point whose position is shown: the source's centroid, or the origin of the "
     "source frame, to which the covariances of posterior.json refer. (default "
     "centroid)")
    ("live", io::flag(view.is_live),
     "Show ICP's iterations and the chains while they run, then the result. Without "
     "it, only the result is shown.")
    ("screenshot", io::fileName("FILE", view.screenshot_file),
     "Write this file, a .png, instead of opening a window. With --live, it shows "
     "the chains' last state.")
    ("size", value("WxH", readSize, view, "WIDTHxHEIGHT in pixels, from 300x200 to 8192x8192"),
     "Size of window or picture [pixels], from 300x200, or 600x400 with -multiview 1. "
     "The legend is left out where it leaves no room. (default 1280x960)");
  // clang-format on
  po::options_description all;
  all.add(general).add(pcl_viewers).add(own);
  app::describeSettings(all);
  return all;
}

io::ToolText
toolText()
{
  return {"pcl_bayesian_icp_viewer " BAYESIAN_ICP_VERSION,
          R"(Usage: pcl_bayesian_icp_viewer SOURCE TARGET [options]
       pcl_bayesian_icp_viewer POSTERIOR.json [SOURCE TARGET] [options]

Registers a source cloud to a target cloud, or opens a result of
pcl_bayesian_icp -o (samples.csv is read from the folder of posterior.json).
Shows the posterior of the pose: how far off each point may be, and which poses
are likely. Clouds are .pcd or .ply files in metres. Everything is in the
target frame. Options begin with one or two dashes.
)",
          '\n' + keysText() + R"(
Exit codes:
  0    the result shown can be trusted
  1    it cannot (the status or a warning in the picture says why), or nothing
       could be shown, for example without an X display (xvfb-run provides one)
  2    wrong usage
  3    a file cannot be read, used or written
  130  interrupted (Ctrl-C or SIGTERM)

Example:
  pcl_bayesian_icp_viewer source.pcd target.pcd --live
  pcl_bayesian_icp_viewer result/posterior.json -multiview 1
  xvfb-run -a pcl_bayesian_icp_viewer result/posterior.json \
      --show target,deviation --screenshot deviation.png --size 800x600
)"};
}

/** Two clouds, or a posterior with or without the two clouds. */
void
takeFiles(const po::variables_map& given, Request& request)
{
  std::vector<std::string> clouds;
  for (const std::string& file : io::optionTexts(given, "file")) {
    if (std::filesystem::path(file).extension() != ".json")
      clouds.push_back(file);
    else if (request.posterior_file.empty())
      request.posterior_file = file;
    else
      throw io::UsageError("expected one posterior, but got a second: " +
                           io::inQuotes(file));
  }
  if (clouds.empty() && !request.posterior_file.empty())
    return;
  if (clouds.size() != 2)
    throw io::UsageError("expected a source and a target cloud, or a posterior.json");
  request.source_file = clouds[0];
  request.target_file = clouds[1];
}

/** Refuses options of a registration, because none takes place. */
void
refuseSettings(const po::variables_map& given)
{
  po::options_description settings;
  settings.add_options()("live", "");
  app::describeSettings(settings);
  for (const auto& option : settings.options())
    io::refuseOptions(
        given, {option->long_name()}, ": has no effect with a finished posterior");
}

} // namespace

Request
parseCommandLine(int argc, const char* const* argv)
{
  Request request;
  const po::options_description options = describeOptions(request);
  const po::variables_map given =
      io::readCommandLine(argc, argv, options, "file", toolText());
  takeFiles(given, request);
  io::takeOptions(given, options);
  const std::string& picture = request.view.screenshot_file;
  if (!picture.empty() &&
      !boost::iequals(std::filesystem::path(picture).extension().string(), ".png"))
    throw io::UsageError("--screenshot: writes PNG files only, and " +
                         io::inQuotes(picture) + " does not end in .png");
  if (given.count("show") > 0 && request.view.is_multiview)
    throw io::UsageError("--show and -multiview 1 exclude each other");
  if (request.view.is_multiview &&
      (request.view.width < 2 * least_width || request.view.height < 2 * least_height))
    throw io::UsageError("--size: with -multiview 1 at least 600x400");
  if (request.posterior_file.empty())
    request.settings = app::settingsFrom(given);
  else
    refuseSettings(given);
  return request;
}

} // namespace bayesian_icp::viewer
