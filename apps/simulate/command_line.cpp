#include "simulate/command_line.h"

#include "io/command_line.h"
#include "io/program.h"

#include <sstream>
#include <stdexcept>

namespace bayesian_icp::simulator {

namespace po = boost::program_options;

namespace {

/** An option that is a list of numbers, as many as \p values has. */
template <typename Vector>
po::typed_value<std::string>*
vector(const char* placeholder, Vector& values)
{
  return io::taken(placeholder, [&values](const std::string& text) {
    const auto items = io::splitAt(',', text);
    Vector numbers = values;
    bool is_good = static_cast<Eigen::Index>(items.size()) == numbers.size();
    for (std::size_t k = 0; is_good && k < items.size(); ++k)
      is_good = io::readNumber(items[k], numbers[static_cast<Eigen::Index>(k)]);
    if (!is_good)
      io::refuseValue(text, io::textOf(values.size()) + " numbers separated by commas");
    values = numbers;
  });
}

void
takeKind(const std::string& name, SensorOptions& sensor)
{
  for (const int rings : {16, 32, 64, 128})
    if (name == "lidar" + std::to_string(rings)) {
      sensor = carLidar(rings);
      return;
    }
  if (name != "depth-camera" && name != "lidar")
    io::refuseValue(name, "depth-camera, lidar, lidar16, lidar32, lidar64 or lidar128");
  const SensorKind kind = name == "lidar" ? SensorKind::Lidar : SensorKind::DepthCamera;
  if (sensor.kind == kind)
    return;
  sensor = SensorOptions();
  sensor.kind = kind;
  if (kind == SensorKind::Lidar)
    sensor.max_range = 30.0;
}

void
takeQuantisation(const std::string& kind, SensorOptions& sensor)
{
  if (kind == "none")
    sensor.quantisation = Quantisation::None;
  else if (kind == "kinect")
    sensor.quantisation = Quantisation::Kinect;
  else {
    io::readValue(kind, sensor.quantisation_step);
    sensor.quantisation = Quantisation::Step;
  }
}

CloudFrame
frameOf(const std::string& name)
{
  if (name != "object" && name != "sensor")
    io::refuseValue(name, "object or sensor");
  return name == "sensor" ? CloudFrame::Sensor : CloudFrame::Object;
}

/** Add the options of the sensor. Its kind comes first, because the others change it.
 */
void
describeSensor(SensorOptions& sensor, po::options_description& all)
{
  po::options_description geometry("Sensor");
  po::options_description noise(
      "Noise of the readings (depth or range; independent in source and target)");
  po::options_description errors("Other errors of the sensor");
  // clang-format off
  geometry.add_options()
    ("sensor", io::taken("KIND", [&sensor](const std::string& name) {
       takeKind(name, sensor);
     }),
     "Kind of sensor: depth-camera, lidar, or a spinning lidar of a car's roof: "
     "lidar16, lidar32 (-15 to 15 degrees, every 0.2), lidar64, lidar128 (-25 to 5 "
     "degrees, every 0.25). Those of a car see 1 to 80 m and have --incidence-noise "
     "0.25 --ring-offset 0.01 --azimuth-phase 1. The other options change these values. "
     "(default depends on the scene)")
    ("width", io::number("N", sensor.camera.width),
     "Camera: columns [pixels]. (default 640)")
    ("height", io::number("N", sensor.camera.height),
     "Camera: rows [pixels]. (default 480)")
    ("fov", io::number("DEG", sensor.camera.horizontal_fov),
     "Camera: horizontal field of view [degrees]. (default 57)")
    ("rings", io::number("N", sensor.lidar.rings),
     "Lidar: number of rings. (default 16; most scenes with a lidar 32)")
    ("min-elevation", io::number("DEG", sensor.lidar.min_elevation),
     "Lidar: lowest ring [degrees]. (default -15; most scenes with a lidar -30)")
    ("max-elevation", io::number("DEG", sensor.lidar.max_elevation),
     "Lidar: highest ring [degrees]. (default 15; most scenes with a lidar 10)")
    ("azimuth-step", io::number("DEG", sensor.lidar.azimuth_step),
     "Lidar: angle between rays [degrees]. (default 0.4)")
    ("azimuth-phase", io::number("PART", sensor.lidar.azimuth_phase),
     "Lidar: turn all rays of a scan by a random part of an azimuth step, at most this "
     "part, 0 to 1. (default 0)")
    ("min-range", io::number("M", sensor.min_range),
     "Nearest reading [m]. (default 0.3; lidar16 to lidar128 1)")
    ("max-range", io::number("M", sensor.max_range),
     "Farthest reading [m]. (default: camera 5, lidar 30, lidar16 to lidar128 80)");
  noise.add_options()
    ("noise", io::number("FACTOR", sensor.noise),
     "Factor on the noise of the reading; 0 means no noise. Camera: 0.0012 + 0.0019 (z "
     "- 0.4)^2 m at depth z (Kinect, Nguyen 2012). (default 1)")
    ("range-noise", io::number("M", sensor.lidar.range_noise),
     "Lidar: standard deviation of the range [m]. (default 0.02)")
    ("noise-correlation", io::number("PART", sensor.noise_correlation),
     "Part of the variance of the reading's noise, 0 to 1, that neighbouring rays "
     "share. (default 0)")
    ("noise-correlation-pixels", io::number("N", sensor.noise_correlation_pixels),
     "Standard deviation of the Gaussian that smooths the shared part [pixels; rings "
     "and azimuth steps]. (default 2.5)")
    ("incidence-noise", io::number("POWER", sensor.incidence_noise),
     "Divide the noise of the reading by cos(angle of incidence) to this power, 0 to 4; "
     "time-of-flight cameras have about 1. It grows tenfold at most. (default 0)");
  errors.add_options()
    ("ring-offset", io::number("M", sensor.lidar.ring_offset),
     "Lidar: standard deviation of the rings' constant offsets of the range [m], the "
     "same in both scans. (default 0)")
    ("sensor-seed", io::number("N", sensor.lidar.sensor_seed),
     "Lidar: seed of these offsets, 0 to 2^64-1. (default 1)")
    ("lateral-noise", io::number("FACTOR", sensor.camera.lateral_noise),
     "Camera: factor on the noise across the ray, about 0.8 pixels (Kinect, Nguyen "
     "2012). (default 0)")
    ("quantisation", io::taken("KIND", [&sensor](const std::string& kind) {
       takeQuantisation(kind, sensor);
     }),
     "Rounding of the readings: none, kinect (camera: 345 m / k, 3 mm at 1 m) or a step "
     "[m]. (default none)")
    ("dropout-from", io::number("DEG", sensor.dropout_from),
     "Angle of incidence [degrees] from which readings get lost, with a probability "
     "that reaches 1 at 90. (default 90: none)")
    ("outliers", io::number("P", sensor.outliers),
     "Probability of a wrong reading, 0 to 1. (default 0)")
    ("outlier-spread", io::number("M", sensor.outlier_spread),
     "Largest error of a wrong reading [m]. (default 0.1)")
    ("jitter", io::number("PART", sensor.jitter),
     "Move each ray at random within this part, 0 to 1, of a pixel or azimuth step. 0 "
     "is the fixed grid of a real sensor. (default 0)");
  // clang-format on
  all.add(geometry).add(noise).add(errors);
}

/** Every option. The scene comes first, because the others change its defaults. */
po::options_description
describeOptions(Request& request)
{
  SimulationOptions& options = request.options;
  View& target = options.target_view;
  View& source = options.source_view;
  po::options_description general("General");
  po::options_description views(
      "Views and frames (world frame, z up; defaults depend on the scene)");
  // clang-format off
  general.add_options()
    ("help,h", "Show this text.")
    ("list-scenes", "List the scenes, with the motions that each leaves unobservable.")
    ("scene", io::taken("NAME", [&request](const std::string& name) {
       request.options = defaultOptions(name);
     }),
     "Scene to scan. (required)")
    ("output,o", io::text("DIR", request.output_folder),
     "Folder to write to; it is made if it is missing. (required)")
    ("seed", io::number("N", request.options.seed),
     "Seed of the noise, 0 to 2^64-1. (default 1)");
  views.add_options()
    ("target-eye", vector("X,Y,Z", target.eye), "Position of the target's sensor [m].")
    ("target-look-at", vector("X,Y,Z", target.look_at),
     "Point at which the target's sensor looks [m].")
    ("source-eye", vector("X,Y,Z", source.eye), "Position of the source's sensor [m].")
    ("source-look-at", vector("X,Y,Z", source.look_at),
     "Point at which the source's sensor looks [m].")
    ("same-view",
     "Scan the source from the target's view. Without it, the source has its own view.")
    ("frame", io::taken("FRAME", [&options](const std::string& name) {
       options.frame = frameOf(name);
     }),
     "Frame of the clouds: 'object' (the world frame) or 'sensor'.")
    ("offset", vector("X,Y,Z,ROLL,PITCH,YAW", options.offset),
     "Pose [m, rad] whose inverse moves the source before it is written. With --frame "
     "object it is the true source-to-target pose.")
    ("sweep-motion", io::number("PART", options.sweep_motion),
     "Part, 0 to 1, of the motion from the target's to the source's view that a lidar "
     "makes at constant velocity during one turn, which begins and ends at the back. "
     "The points are not corrected for it; the true pose is that in the middle of both "
     "turns. With 1 the second scan follows the first immediately. (default 0)");
  // clang-format on
  po::options_description all;
  all.add(general).add(views);
  describeSensor(options.sensor, all);
  return all;
}

std::string
helpText(const po::options_description& options)
{
  std::ostringstream help;
  help << R"(Usage: pcl_bayesian_icp_simulate --scene NAME -o DIR [options]

Scans a simulated scene twice. Writes source.pcd, target.pcd,
T_target_source.txt (maps source points into the target frame) and scene.json
(all options, so that the pair can be made again).
Exit codes: 0 good, 1 out of memory, 2 usage, 3 cannot write, 130 interrupted.
)" << options;
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

} // namespace

std::optional<Request>
parseCommandLine(int argc, const char* const* argv)
{
  Request request;
  const po::options_description options = describeOptions(request);
  const po::variables_map given = io::splitCommandLine(argc, argv, options, nullptr);
  if (io::printHelpOrVersion(given, "", [&options] { return helpText(options); }))
    return std::nullopt;
  if (given.count("list-scenes") > 0) {
    io::print(sceneList());
    return std::nullopt;
  }
  for (const char* required : {"scene", "output"})
    if (given.count(required) == 0)
      throw io::UsageError(std::string("--") + required + " is missing");
  io::takeOptions(given, options);
  View& source = request.options.source_view;
  const bool is_same_view = given.count("same-view") > 0;
  if (is_same_view && given.count("source-eye") == 0)
    source.eye = request.options.target_view.eye;
  if (is_same_view && given.count("source-look-at") == 0)
    source.look_at = request.options.target_view.look_at;
  validate(request.options);
  return request;
}

} // namespace bayesian_icp::simulator
