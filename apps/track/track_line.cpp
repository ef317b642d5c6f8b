#include "track/track_line.h"

#include "io/coordinates.h"
#include "io/errors.h"
#include "io/numbers.h"
#include "io/text_hash.h"
#include "io/time_stamps.h"
#include "register/choices.h"
#include "register/json_values.h"
#include "register/posterior_files.h"
#include "register/settings_json.h"

#include <algorithm>
#include <stdexcept>

namespace bayesian_icp::app {

namespace {

using nlohmann::json;
using nlohmann::ordered_json;

ordered_json
poseJson(const GaussianPose& pose)
{
  return {
      {"mean", meanJson(pose.mean)},
      {"covariance", covarianceJson(CovarianceConvention::RightSE3, pose.covariance)}};
}

GaussianPose
readPose(const json& value)
{
  GaussianPose pose;
  for (std::size_t k = 0; k < 6; ++k)
    pose.mean[static_cast<Eigen::Index>(k)] =
        value.at("mean").at(coordinateKey(k)).get<double>();
  const json& matrix = value.at("covariance").at("matrix");
  for (Eigen::Index row = 0; row < 6; ++row)
    for (Eigen::Index column = 0; column < 6; ++column)
      pose.covariance(row, column) =
          matrix.at(std::size_t(row)).at(std::size_t(column)).get<double>();
  return pose;
}

ordered_json
edgeJson(const TrackEdge& edge)
{
  ordered_json value = {{"target", edge.target},
                        {"num_unmeasured", edge.num_unmeasured}};
  value.update(poseJson(edge.pose));
  return value;
}

TrackEdge
readEdge(const json& value)
{
  return {value.at("target"), readPose(value), value.at("num_unmeasured")};
}

/** Differs if something differs that decides the result of a track: a line with another
 * one is not of this track. */
std::string
settingsIdOf(const TrackRequest& request)
{
  Settings settings = request.settings;
  settings.options.chains.num_threads = 0; // no result depends on it
  const ordered_json all = {jsonOf(settings),
                            request.acceleration,
                            request.angular_acceleration,
                            request.span,
                            request.voxel_size,
                            request.map_scans,
                            request.scans.front(),
                            request.times.front(),
                            BAYESIAN_ICP_VERSION};
  return io::textOfHash(io::hashOf(jsonText(all)));
}

} // namespace

std::string
trackLine(const TrackRequest& request, const Track& track)
{
  const TrackStep& step = track.steps().back();
  const auto k = static_cast<std::size_t>(step.scan);
  std::string message = step.message;
  std::replace(message.begin(), message.end(), '\n', ' ');
  const ordered_json line = {{"scan", step.scan},
                             {"file", request.scans.at(k)},
                             {"time_s", io::secondsOf(request.times.at(k))},
                             {"kind", toString(step.kind)},
                             {"status", step.status},
                             {"message", message},
                             {"edge", edgeJson(step.edge)},
                             {"more_edges", listOf(step.more_edges, edgeJson)},
                             {"is_velocity_doubted", step.is_velocity_doubted},
                             {"innovation", track.innovations().back()},
                             {"pose_in_scan_0", poseJson(track.poses().back())},
                             {"seconds", step.seconds},
                             {"settings_id", settingsIdOf(request)},
                             {"files_state", step.files_state}};
  return jsonText(line);
}

TrackStep
readTrackLine(const std::string& line, const TrackRequest& request, int scan)
{
  const json document = json::parse(line);
  const auto k = static_cast<std::size_t>(scan);
  const std::string name = "scan " + std::to_string(scan);
  if (document.at("scan") != scan)
    throw std::runtime_error("it is not about " + name);
  if (k >= request.scans.size())
    throw std::runtime_error("there is no " + name);
  if (const std::string file = document.at("file");
      file != json::parse(jsonText(request.scans[k])))
    throw std::runtime_error(name + " is another file here, " +
                             io::inQuotes(request.scans[k]) + " in place of " +
                             io::inQuotes(file));
  if (document.at("time_s") != io::secondsOf(request.times[k]))
    throw std::runtime_error(name + " has another time here");
  if (document.at("settings_id") != settingsIdOf(request))
    throw std::runtime_error("it was made with other settings or another version");
  TrackStep step;
  step.scan = scan;
  if (!readChoice(document.at("kind").get<std::string>(), step.kind))
    throw std::runtime_error("its kind is none");
  step.status = document.at("status");
  step.message = document.at("message");
  step.edge = readEdge(document.at("edge"));
  for (const json& edge : document.at("more_edges"))
    step.more_edges.push_back(readEdge(edge));
  step.is_velocity_doubted = document.at("is_velocity_doubted");
  step.seconds = document.at("seconds");
  step.files_state = document.at("files_state");
  return step;
}

} // namespace bayesian_icp::app
