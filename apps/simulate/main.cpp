/** \file
 * \brief pcl_bayesian_icp_simulate: scans a simulated scene twice and writes the two
 * clouds with the transform between them.
 */
#include "io/interrupt.h"
#include "io/numbers.h"
#include "io/output_folder.h"
#include "io/program.h"
#include "register/json_values.h"
#include "simulate/command_line.h"
#include "simulator/option_fields.h"

#include <pcl/io/pcd_io.h>
#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <nlohmann/json.hpp>

#include <stdexcept>
#include <type_traits>

namespace bayesian_icp::simulator {
namespace {

using Json = nlohmann::ordered_json;

/** Binary compressed, x, y, z only. */
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

/** A number, a name, a vector or a matrix. */
template <typename Value>
Json
jsonOf(const Value& value)
{
  if constexpr (std::is_base_of_v<Eigen::MatrixBase<Value>, Value>)
    return app::jsonOf(value);
  else
    return value;
}

Json
jsonOf(CloudFrame frame)
{
  return frame == CloudFrame::Sensor ? "sensor" : "object";
}

Json
jsonOf(SensorKind kind)
{
  return kind == SensorKind::Lidar ? "lidar" : "depth-camera";
}

Json
jsonOf(Quantisation quantisation)
{
  return quantisation == Quantisation::Kinect ? "kinect" : "none";
}

/** Every option that has an effect, under its name on the command line. */
Json
optionsRecord(const SimulationOptions& options)
{
  Json record;
  visitOptions(options, [&record](const OptionField& field, const auto& value) {
    if (field.no_effect == nullptr)
      record[field.name] = jsonOf(value);
  });
  if (options.sensor.quantisation == Quantisation::Step)
    record["quantisation"] = options.sensor.quantisation_step;
  return record;
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

/** A command line, without the output folder, that spells out every option and
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

/** The content of scene.json: full command line, options, frames, transforms. */
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
  record["T_target_source"] = jsonOf(pair.T_target_source);
  record["T_source_world"] = jsonOf(pair.T_source_world);
  record["T_target_world"] = jsonOf(pair.T_target_world);
  return record;
}

/** All files, each complete, or none. */
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
    const Eigen::IOFormat plain(17, Eigen::DontAlignCols, " ", "\n", "", "", "", "\n");
    stream << pair.T_target_source.format(plain);
  });
  files.add("scene.json", recordOf(options, pair).dump(2) + '\n');
  files.commit();
}

int
runTool(int argc, const char* const* argv)
{
  Request request;
  ScanPair pair;
  try {
    request = parseCommandLine(argc, argv);
    pair = simulate(request.options);
  }
  catch (const std::invalid_argument& error) {
    throw io::UsageError(error.what());
  }
  io::catchInterrupt(); // from here on all files or none
  writePair(request.output_folder, request.options, pair);
  io::print(request.output_folder + ": " + request.options.scene + ", source " +
            std::to_string(pair.source.cols()) + " points, target " +
            std::to_string(pair.target.cols()) + " points\n");
  return io::wasInterrupted() ? io::Interrupted : io::Good;
}

} // namespace
} // namespace bayesian_icp::simulator

int
main(int argc, char** argv)
{
  using namespace bayesian_icp;
  return io::runProgram("pcl_bayesian_icp_simulate",
                        [&] { return simulator::runTool(argc, argv); });
}
