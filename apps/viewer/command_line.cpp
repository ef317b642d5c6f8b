#include "viewer/command_line.h"

#include "io/command_line.h"
#include "io/errors.h"
#include "register/option_descriptions.h"
#include "register/settings_options.h"
#include "viewer/option_descriptions.h"
#include "viewer/option_values.h"

#include <boost/program_options/variables_map.hpp>

#include <vector>

namespace bayesian_icp::viewer {

namespace po = boost::program_options;

namespace {

bool
isPosterior(const std::string& name)
{
  const std::string ending = ".json";
  return name.size() > ending.size() &&
         name.compare(name.size() - ending.size(), ending.size(), ending) == 0;
}

/** Two clouds, or a posterior with or without the two clouds. */
void
takeFiles(const po::variables_map& given, Request& request)
{
  std::vector<std::string> clouds;
  for (const std::string& file : io::optionTexts(given, "file")) {
    if (!isPosterior(file))
      clouds.push_back(file);
    else if (request.posterior_file.empty())
      request.posterior_file = file;
    else
      throw io::UsageError("expected one posterior, but got a second: " +
                           io::quoted(file));
  }
  if (clouds.empty() && !request.posterior_file.empty())
    return;
  if (clouds.size() != 2)
    throw io::UsageError("expected a source and a target cloud, or a posterior.json");
  request.source_file = clouds[0];
  request.target_file = clouds[1];
}

/** Options of pcl_viewer that are given once for each cloud. */
template <typename Value, typename Read>
void
takeRepeated(const po::variables_map& given,
             const std::string& name,
             const Read& read,
             std::vector<Value>& values)
{
  for (const std::string& text : io::optionTexts(given, name))
    values.push_back(read(name, text));
  if (values.size() > 3)
    throw io::UsageError("-" + name +
                         ": given more than three times (source, target, aligned)");
}

void
takePclViewerOptions(const po::variables_map& given, ViewOptions& view)
{
  const auto textOf = [&given](const char* name) {
    return io::optionText(given, name);
  };
  if (given.count("bc") > 0)
    view.background = readColor("bc", textOf("bc"));
  takeRepeated(given, "fc", readColor, view.foregrounds);
  takeRepeated(given, "ps", readPointSize, view.point_sizes);
  takeRepeated(given, "opaque", readOpacity, view.opacities);
  if (given.count("ax") > 0)
    view.axes_scale = readNonNegative("ax", textOf("ax"));
  view.camera = textOf("cam");
  if (given.count("multiview") > 0)
    view.is_multiview = readSwitch("multiview", textOf("multiview"));
}

void
takeOwnOptions(const po::variables_map& given, ViewOptions& view)
{
  const auto textOf = [&given](const char* name) {
    return io::optionText(given, name);
  };
  if (given.count("show") > 0)
    view.layers = readLayers(textOf("show"));
  if (given.count("show") > 0 && view.is_multiview)
    throw io::UsageError("--show and -multiview 1 exclude each other");
  if (given.count("draws") > 0)
    view.num_draws = readNumDraws("draws", textOf("draws"));
  if (given.count("magnify") > 0)
    view.magnification = readMagnification(textOf("magnify"));
  if (given.count("reference") > 0)
    view.reference = readReference(textOf("reference"));
  view.is_live = given.count("live") > 0;
  view.screenshot_file = textOf("screenshot");
  view.is_size_given = given.count("size") > 0;
  if (view.is_size_given)
    readSize(textOf("size"), view.width, view.height);
}

/** Refuses options of a registration, because none takes place. */
void
refuseSettings(const po::variables_map& given)
{
  if (given.count("live") > 0)
    throw io::UsageError("--live: has no effect with a finished posterior");
  po::options_description settings;
  app::describeSettings(app::Settings(), settings);
  for (const auto& option : settings.options())
    if (given.count(option->long_name()) > 0)
      throw io::UsageError("--" + option->long_name() +
                           ": has no effect with a finished posterior");
}

} // namespace

Request
parseCommandLine(int argc, const char* const* argv)
{
  const po::variables_map given =
      io::splitCommandLine(argc, argv, describeOptions(), "file");
  Request request;
  if (given.count("help") > 0 || given.count("version") > 0) {
    request.kind =
        given.count("help") > 0 ? Request::Kind::ShowHelp : Request::Kind::ShowVersion;
    return request;
  }
  takeFiles(given, request);
  takePclViewerOptions(given, request.view);
  takeOwnOptions(given, request.view);
  request.is_quiet = given.count("quiet") > 0;
  if (request.posterior_file.empty())
    request.settings = app::settingsFrom(given, app::Settings(), request.note);
  else
    refuseSettings(given);
  return request;
}

} // namespace bayesian_icp::viewer
