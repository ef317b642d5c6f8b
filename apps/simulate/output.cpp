#include "simulate/output.h"

#include "io/numbers.h"
#include "io/output_folder.h"

#include <pcl/io/pcd_io.h>
#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <nlohmann/json.hpp>

#include <iomanip>
#include <sstream>
#include <stdexcept>

namespace bayesian_icp::simulator {

using Json = nlohmann::ordered_json;

namespace {

/** \brief Binary compressed, x, y, z only. */
void
writeCloud(const Eigen::Matrix3Xf& points, std::ostream& stream)
{
  pcl::PointCloud<pcl::PointXYZ> cloud;
  cloud.reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    cloud.push_back(pcl::PointXYZ(points(0, i), points(1, i), points(2, i)));
  pcl::PCLPointCloud2 blob;
  pcl::toPCLPointCloud2(cloud, blob);
  if (pcl::PCDWriter().writeBinaryCompressed(
          stream, blob, cloud.sensor_origin_, cloud.sensor_orientation_) < 0)
    throw std::runtime_error("PCL cannot write the cloud");
}

std::string
textOfMatrix(const Eigen::Matrix4d& matrix)
{
  std::ostringstream text;
  text << std::setprecision(17);
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      text << matrix(row, column) << (column < 3 ? ' ' : '\n');
  return text.str();
}

template <typename Vector>
Json
arrayOf(const Vector& values)
{
  Json array = Json::array();
  for (Eigen::Index i = 0; i < values.size(); ++i)
    array.push_back(values[i]);
  return array;
}

Json
rowsOf(const Eigen::Matrix4d& matrix)
{
  Json rows = Json::array();
  for (int row = 0; row < 4; ++row)
    rows.push_back(arrayOf(matrix.row(row)));
  return rows;
}

void
addKindOfSensor(const SensorOptions& sensor, Json& options)
{
  if (sensor.kind == SensorKind::DepthCamera) {
    options["sensor"] = "depth-camera";
    options["width"] = sensor.camera.width;
    options["height"] = sensor.camera.height;
    options["fov"] = sensor.camera.horizontal_fov;
    options["lateral-noise"] = sensor.camera.lateral_noise;
    return;
  }
  options["sensor"] = "lidar";
  options["rings"] = sensor.lidar.rings;
  options["min-elevation"] = sensor.lidar.min_elevation;
  options["max-elevation"] = sensor.lidar.max_elevation;
  options["azimuth-step"] = sensor.lidar.azimuth_step;
  options["azimuth-phase"] = sensor.lidar.azimuth_phase;
  options["range-noise"] = sensor.lidar.range_noise;
  options["ring-offset"] = sensor.lidar.ring_offset;
  options["sensor-seed"] = sensor.lidar.sensor_seed;
}

/** \brief What changes the noise of the reading, where it is switched on; of a LiDAR
 * also its incidence-noise of zero, as some scenes have another one. */
void
addOptionalNoise(const SensorOptions& sensor, Json& options)
{
  if (sensor.noise_correlation > 0.0) {
    options["noise-correlation"] = sensor.noise_correlation;
    options["noise-correlation-pixels"] = sensor.noise_correlation_pixels;
  }
  if (sensor.incidence_noise > 0.0 || sensor.kind == SensorKind::Lidar)
    options["incidence-noise"] = sensor.incidence_noise;
}

Json
quantisationOf(const SensorOptions& sensor)
{
  switch (sensor.quantisation) {
  case Quantisation::Kinect:
    return "kinect";
  case Quantisation::Step:
    return sensor.quantisation_step;
  case Quantisation::None:
    break;
  }
  return "none";
}

/** \brief Every option under its name on the command line; of a
 * camera's noise that is correlated or grows with the angle of incidence, and of the
 * motion during a scan, only what is switched on. */
Json
optionsRecord(const SimulationOptions& simulation)
{
  const SensorOptions& sensor = simulation.sensor;
  Json options;
  options["scene"] = simulation.scene;
  options["seed"] = simulation.seed;
  options["target-eye"] = arrayOf(simulation.target_view.eye);
  options["target-look-at"] = arrayOf(simulation.target_view.look_at);
  options["source-eye"] = arrayOf(simulation.source_view.eye);
  options["source-look-at"] = arrayOf(simulation.source_view.look_at);
  options["frame"] = simulation.frame == CloudFrame::Sensor ? "sensor" : "object";
  options["offset"] = arrayOf(simulation.offset);
  if (simulation.sweep_motion > 0.0)
    options["sweep-motion"] = simulation.sweep_motion;
  addKindOfSensor(sensor, options);
  options["min-range"] = sensor.min_range;
  options["max-range"] = sensor.max_range;
  options["noise"] = sensor.noise;
  addOptionalNoise(sensor, options);
  options["quantisation"] = quantisationOf(sensor);
  options["dropout-from"] = sensor.dropout_from;
  options["outliers"] = sensor.outliers;
  options["outlier-spread"] = sensor.outlier_spread;
  options["jitter"] = sensor.jitter;
  return options;
}

std::string
commandLineValue(const Json& value)
{
  if (value.is_string())
    return value.get<std::string>();
  if (value.is_number_float())
    return io::textOf(value.get<double>());
  if (!value.is_array())
    return value.dump();
  std::string list;
  for (const Json& item : value)
    list += (list.empty() ? "" : ",") + commandLineValue(item);
  return list;
}

/** \brief A command line, without the output folder, that spells out every option and
 * so makes the same pair even if a default changes. */
std::string
fullCommandLine(const SimulationOptions& options)
{
  std::string line = "pcl_bayesian_icp_simulate";
  const Json record = optionsRecord(options);
  for (const auto& option : record.items())
    line += " --" + option.key() + " " + commandLineValue(option.value());
  return line;
}

/** \brief The content of scene.json: full command line, options, frames, transforms. */
Json
recordOf(const SimulationOptions& options, const ScanPair& pair)
{
  const Scene scene = makeScene(options.scene);
  Json record;
  record["schema"] = "pcl_bayesian_icp_simulate/1";
  record["units"] = "metres, radians; options with angles of the sensor: degrees";
  record["description"] = scene.description;
  record["unobservable"] = scene.unobservable;
  record["command_line"] = fullCommandLine(options);
  record["options"] = optionsRecord(options);
  record["points"] = {{"source", pair.source.cols()}, {"target", pair.target.cols()}};
  record["T_target_source"] = rowsOf(pair.T_target_source);
  record["T_source_world"] = rowsOf(pair.T_source_world);
  record["T_target_world"] = rowsOf(pair.T_target_world);
  return record;
}

} // namespace

void
writePair(const std::string& folder,
          const SimulationOptions& options,
          const ScanPair& pair)
{
  io::OutputFolder files(folder);
  files.add("source.pcd",
            [&](std::ostream& stream) { writeCloud(pair.source, stream); });
  files.add("target.pcd",
            [&](std::ostream& stream) { writeCloud(pair.target, stream); });
  files.add("T_target_source.txt", [&](std::ostream& stream) {
    stream << textOfMatrix(pair.T_target_source);
  });
  files.add("scene.json", [&](std::ostream& stream) {
    stream << recordOf(options, pair).dump(2) << '\n';
  });
  files.commit();
}

} // namespace bayesian_icp::simulator
