#include "simulate/command_line.h"

#include "io/command_line.h"
#include "io/program.h"
#include "simulator/option_fields.h"

#include <array>
#include <sstream>
#include <type_traits>

namespace bayesian_icp::simulator {

namespace po = boost::program_options;

namespace {

template <typename Number>
std::enable_if_t<std::is_arithmetic_v<Number>>
take(const std::string& text, Number& value, SimulationOptions&)
{
  io::readValue(text, value);
}

/** A list of numbers, as many as \p values has. */
template <int size>
void
take(const std::string& text,
     Eigen::Matrix<double, size, 1>& values,
     SimulationOptions&)
{
  if (!io::readNumbers(text, values))
    io::refuseValue(text, io::textOf(size) + " numbers separated by commas");
}

/** The scene, which changes all options. */
void
take(const std::string& name, std::string&, SimulationOptions& options)
{
  options = defaultOptions(name);
}

void
take(const std::string& name, CloudFrame& frame, SimulationOptions&)
{
  if (name != "object" && name != "sensor")
    io::refuseValue(name, "object or sensor");
  frame = name == "sensor" ? CloudFrame::Sensor : CloudFrame::Object;
}

/** The kind of sensor, which changes all its options. */
void
take(const std::string& name, SensorKind& kind, SimulationOptions& options)
{
  SensorOptions& sensor = options.sensor;
  for (const int rings : {16, 32, 64, 128})
    if (name == "lidar" + std::to_string(rings)) {
      sensor = carLidar(rings);
      return;
    }
  if (name != "depth-camera" && name != "lidar")
    io::refuseValue(name, "depth-camera, lidar, lidar16, lidar32, lidar64 or lidar128");
  const SensorKind given =
      name == "lidar" ? SensorKind::Lidar : SensorKind::DepthCamera;
  if (kind == given)
    return;
  sensor = SensorOptions();
  kind = given;
  if (kind == SensorKind::Lidar)
    sensor.max_range = 30.0;
}

void
take(const std::string& kind, Quantisation& quantisation, SimulationOptions& options)
{
  if (kind == "none")
    quantisation = Quantisation::None;
  else if (kind == "kinect")
    quantisation = Quantisation::Kinect;
  else {
    io::readValue(kind, options.sensor.quantisation_step);
    quantisation = Quantisation::Step;
  }
}

po::options_description
describeOptions(Request& request)
{
  std::array<po::options_description, 5> groups = {
      io::generalOptions(),
      po::options_description(
          "Views and frames (world frame, z up; defaults depend on the scene)"),
      po::options_description("Sensor"),
      po::options_description(
          "Noise of the readings (depth or range; independent in source and target)"),
      po::options_description("Other errors of the sensor")};
  auto& general = groups[static_cast<std::size_t>(OptionGroup::General)];
  auto& views = groups[static_cast<std::size_t>(OptionGroup::Views)];
  SimulationOptions& options = request.options;
  visitOptions(options, [&groups, &options](const OptionField& field, auto& value) {
    groups[static_cast<std::size_t>(field.group)].add_options()(
        field.name,
        io::taken(field.placeholder,
                  [&options, &value](const std::string& text) {
                    take(text, value, options);
                  }),
        field.help);
  });
  // clang-format off
  general.add_options()
    ("output,o", io::fileName("DIR", request.output_folder),
     "Folder to write to; it is created if it is missing. (required)")
    ("list-scenes", "List the scenes, with the motions that each leaves unobservable.");
  views.add_options()
    ("same-view",
     "Scan the source from the target's view. Without it, the source has its own view.");
  // clang-format on
  po::options_description all;
  for (const po::options_description& group : groups)
    all.add(group);
  return all;
}

const io::ToolText tool_text = {
    "pcl_bayesian_icp_simulate " BAYESIAN_ICP_VERSION,
    R"(Usage: pcl_bayesian_icp_simulate --scene NAME -o DIR [options]

Scans a simulated scene twice. Writes source.pcd, target.pcd,
T_target_source.txt (maps source points into the target frame) and scene.json
(all options, so that the pair can be made again).
Exit codes: 0 success, 1 out of memory, 2 usage, 3 cannot write,
130 interrupted.
)",
    ""};

std::string
sceneList()
{
  std::ostringstream list;
  for (const std::string& name : sceneNames()) {
    const Scene scene = makeScene(name);
    list << name << ": " << scene.description
         << "\n    unobservable: " << scene.unobservable << '\n';
  }
  return list.str();
}

/** \throws io::UsageError of an option without effect, unless it is 0 */
void
refuseOptionsWithoutEffect(const po::variables_map& given,
                           const SimulationOptions& options)
{
  visitOptions(options, [&given](const OptionField& field, const auto& value) {
    if constexpr (std::is_arithmetic_v<std::decay_t<decltype(value)>>)
      if (given.count(field.name) > 0 && field.no_effect != nullptr && value != 0)
        throw io::UsageError(std::string("--") + field.name + ": has no effect " +
                             field.no_effect);
  });
}

} // namespace

Request
parseCommandLine(int argc, const char* const* argv)
{
  Request request;
  const po::options_description options = describeOptions(request);
  const po::variables_map given =
      io::readCommandLine(argc, argv, options, nullptr, tool_text);
  if (given.count("list-scenes") > 0) {
    io::print(sceneList());
    throw io::Answered();
  }
  for (const char* required : {"scene", "output"})
    if (given.count(required) == 0)
      throw io::UsageError(std::string("--") + required + " is missing");
  io::takeOptions(given, options);
  if (given.count("same-view") > 0) {
    constexpr char reason[] = ": has no effect with --same-view";
    io::refuseOptions(given, {"source-eye", "source-look-at"}, reason);
    if (request.options.sweep_motion != 0.0)
      throw io::UsageError(std::string("--sweep-motion") + reason);
    request.options.source_view = request.options.target_view;
  }
  validate(request.options);
  refuseOptionsWithoutEffect(given, request.options);
  return request;
}

} // namespace bayesian_icp::simulator
