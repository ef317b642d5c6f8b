#include "simulate/command_line.h"

#include "simulate/option_descriptions.h"
#include "simulate/option_numbers.h"

#include <boost/program_options.hpp>

#include <sstream>
#include <stdexcept>
#include <vector>

namespace bayesian_icp::simulator {

namespace po = boost::program_options;

namespace {

/** \brief Reads the options that the command line has. */
class GivenOptions {
public:
  explicit GivenOptions(const po::variables_map& given) : given_(given) {}

  bool
  has(const std::string& name) const
  {
    return given_.count(name) > 0;
  }

  std::string
  text(const std::string& name) const
  {
    return given_[name].as<std::string>();
  }

  template <typename Number>
  void
  takeNumber(const std::string& name, Number& value) const
  {
    if (has(name))
      value = numberOf<Number>(text(name), name);
  }

  /** \brief Comma-separated numbers, as many as \p values has. */
  template <typename Vector>
  void
  takeVector(const std::string& name, Vector& values) const
  {
    if (!has(name))
      return;
    std::istringstream list(text(name) + ',');
    std::vector<double> numbers;
    for (std::string item; std::getline(list, item, ',');)
      numbers.push_back(numberOf<double>(item, name));
    if (static_cast<Eigen::Index>(numbers.size()) != values.size())
      throw std::invalid_argument("--" + name + " takes " + textOf(values.size()) +
                                  " numbers separated by commas, not '" + text(name) +
                                  "'");
    values = Eigen::Map<const Vector>(numbers.data());
  }

private:
  const po::variables_map& given_;
};

void
takeKindOfSensor(const GivenOptions& given, SensorOptions& sensor)
{
  if (!given.has("sensor"))
    return;
  const std::string name = given.text("sensor");
  for (const int rings : {16, 32, 64, 128})
    if (name == "lidar" + std::to_string(rings)) {
      sensor = carLidar(rings);
      return;
    }
  if (name != "depth-camera" && name != "lidar")
    throw std::invalid_argument("--sensor is depth-camera, lidar, lidar16, lidar32, "
                                "lidar64 or lidar128, not '" +
                                name + "'");
  const SensorKind kind = name == "lidar" ? SensorKind::Lidar : SensorKind::DepthCamera;
  if (sensor.kind == kind)
    return;
  sensor = SensorOptions();
  sensor.kind = kind;
  if (kind == SensorKind::Lidar)
    sensor.max_range = 30.0;
}

void
takeQuantisation(const GivenOptions& given, SensorOptions& sensor)
{
  if (!given.has("quantisation"))
    return;
  const std::string value = given.text("quantisation");
  if (value == "none")
    sensor.quantisation = Quantisation::None;
  else if (value == "kinect")
    sensor.quantisation = Quantisation::Kinect;
  else {
    sensor.quantisation = Quantisation::Step;
    given.takeNumber("quantisation", sensor.quantisation_step);
  }
}

void
takeSensor(const GivenOptions& given, SensorOptions& sensor)
{
  takeKindOfSensor(given, sensor);
  takeQuantisation(given, sensor);
  given.takeNumber("width", sensor.camera.width);
  given.takeNumber("height", sensor.camera.height);
  given.takeNumber("fov", sensor.camera.horizontal_fov);
  given.takeNumber("lateral-noise", sensor.camera.lateral_noise);
  given.takeNumber("rings", sensor.lidar.rings);
  given.takeNumber("min-elevation", sensor.lidar.min_elevation);
  given.takeNumber("max-elevation", sensor.lidar.max_elevation);
  given.takeNumber("azimuth-step", sensor.lidar.azimuth_step);
  given.takeNumber("range-noise", sensor.lidar.range_noise);
  given.takeNumber("ring-offset", sensor.lidar.ring_offset);
  given.takeNumber("sensor-seed", sensor.lidar.sensor_seed);
  given.takeNumber("azimuth-phase", sensor.lidar.azimuth_phase);
  given.takeNumber("noise", sensor.noise);
  given.takeNumber("noise-correlation", sensor.noise_correlation);
  given.takeNumber("noise-correlation-pixels", sensor.noise_correlation_pixels);
  given.takeNumber("incidence-noise", sensor.incidence_noise);
  given.takeNumber("dropout-from", sensor.dropout_from);
  given.takeNumber("outliers", sensor.outliers);
  given.takeNumber("outlier-spread", sensor.outlier_spread);
  given.takeNumber("jitter", sensor.jitter);
  given.takeNumber("min-range", sensor.min_range);
  given.takeNumber("max-range", sensor.max_range);
}

void
takeViews(const GivenOptions& given, SimulationOptions& options)
{
  given.takeVector("target-eye", options.target_view.eye);
  given.takeVector("target-look-at", options.target_view.look_at);
  if (given.has("same-view"))
    options.source_view = options.target_view;
  given.takeVector("source-eye", options.source_view.eye);
  given.takeVector("source-look-at", options.source_view.look_at);
  given.takeVector("offset", options.offset);
  given.takeNumber("sweep-motion", options.sweep_motion);
  if (!given.has("frame"))
    return;
  const std::string frame = given.text("frame");
  if (frame != "object" && frame != "sensor")
    throw std::invalid_argument("--frame is object or sensor, not '" + frame + "'");
  options.frame = frame == "sensor" ? CloudFrame::Sensor : CloudFrame::Object;
}

po::variables_map
splitCommandLine(int argc, const char* const* argv)
{
  namespace style = po::command_line_style;
  // No guessing: an abbreviated or misspelt option is an error.
  const int accepted =
      (style::unix_style | style::allow_long_disguise) & ~style::allow_guessing;
  po::variables_map given;
  po::store(po::command_line_parser(argc, argv)
                .options(allOptions())
                .positional(po::positional_options_description())
                .style(accepted)
                .run(),
            given);
  return given;
}

} // namespace

Request
parseCommandLine(int argc, const char* const* argv)
{
  const po::variables_map variables = splitCommandLine(argc, argv);
  const GivenOptions given(variables);
  Request request;
  if (given.has("help") || given.has("list-scenes")) {
    request.kind =
        given.has("help") ? Request::Kind::ShowHelp : Request::Kind::ListScenes;
    return request;
  }
  for (const char* required : {"scene", "output"})
    if (!given.has(required))
      throw std::invalid_argument(std::string("--") + required + " is missing");
  request.output_folder = given.text("output");
  request.options = defaultOptions(given.text("scene"));
  given.takeNumber("seed", request.options.seed);
  takeSensor(given, request.options.sensor);
  takeViews(given, request.options);
  validate(request.options);
  return request;
}

std::string
helpText()
{
  std::ostringstream help;
  help << R"(Usage: pcl_bayesian_icp_simulate --scene NAME -o DIR [options]

Scans a simulated scene twice. Writes source.pcd, target.pcd,
T_target_source.txt (maps source points into the target frame) and scene.json
(all options, so that the pair can be made again).
Exit codes: 0 good, 1 out of memory, 2 usage, 3 cannot write, 130 interrupted.
)" << allOptions();
  return help.str();
}

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

} // namespace bayesian_icp::simulator
