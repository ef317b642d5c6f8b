#include "track/track_command.h"

#include "io/command_line.h"
#include "io/folders.h"
#include "io/input_file.h"
#include "io/time_stamps.h"
#include "register/settings_options.h"

#include <algorithm>
#include <filesystem>

namespace bayesian_icp::app {

namespace po = boost::program_options;

namespace {

/** [s] */
constexpr double shortest_interval = 1e-9;
/** Larger ones are a mistake, and overflow in time. */
constexpr double max_acceleration = 1e6, min_acceleration = 1e-9;
/** [m] */
constexpr double min_voxel_size = 1e-6;
constexpr int max_map_scans = 1000;
constexpr std::uint64_t max_size_of_times = 100'000'000;

/** What decides the times, as it is given. */
struct TimeOptions {
  double period = 0.1;
  std::string source;
};

po::options_description
describeOptionsOfTrack(TrackCommand& command, TimeOptions& times)
{
  TrackRequest& request = command.request;
  po::options_description group = io::generalOptions();
  // clang-format off
  group.add_options()
    ("output,o", io::fileName("FOLDER", command.output_folder),
     "Folder for the results. If it has the results of the same track, interrupted, "
     "the track continues, from the first scan on whose file has changed. (required)")
    ("span", io::number("N", request.span),
     "Also register each scan to those up to N before it. These edges go to edges.jsonl "
     "and graph.g2o only. (default 1)")
    ("quiet", io::flag(command.is_quiet), "Print problems only.");
  po::options_description motion("Motion");
  motion.add_options()
    ("period", io::number("S", times.period),
     "Time from one scan to the next (s). (default 0.1)")
    ("times", io::text("names|FILE", times.source),
     "Times of the scans (s): names, if the file names without extension are the times; "
     "or a file with one number per line.")
    ("acceleration", io::number("A", request.acceleration),
     "Standard deviation of the acceleration along each axis of the sensor (m/s^2). "
     "(default 5)")
    ("angular-acceleration", io::number("A", request.angular_acceleration),
     "Standard deviation of the acceleration about each axis (rad/s^2). (default 5)");
  po::options_description map("Local map");
  map.add_options()
    ("map", io::number("M", request.voxel_size),
     "Register scans to a map of the last scans, with one point in each cube of this "
     "width (m). Without it, each scan is registered to the one before it.")
    ("map-scans", io::number("N", request.map_scans),
     "Number of scans in a map. After this many scans a new map begins. (default 5)");
  // clang-format on
  po::options_description all;
  all.add(group).add(motion).add(map);
  describeSettings(all);
  return all;
}

/** In ns. \param[in] seconds as they are given, or a product of those */
std::int64_t
timeOf(std::string_view seconds, const std::string& where)
{
  double time = 0.0;
  if (!io::readNumber(seconds, time))
    throw io::FileError(where, io::inQuotes(seconds) + " is not a number (s)");
  if (!(time >= 0.0 && time < io::time_limit))
    throw io::FileError(
        where, "the time " + io::textOf(time) + " s is not from 0 to below 2^31 s");
  constexpr std::size_t num_decimals = 9;
  const std::size_t point = seconds.find('.');
  if (point != seconds.npos && seconds.find_first_not_of("0123456789.") == seconds.npos)
    seconds = seconds.substr(0, point + 1 + num_decimals);
  std::int64_t exact = io::nanosecondsOf(time);
  io::readSeconds(seconds, exact);
  return exact;
}

void
requireIntervals(const std::vector<std::int64_t>& times, const std::string& where)
{
  constexpr int longest = 100'000; // [s]; the motion in between is anybody's guess
  for (std::size_t k = 1; k < times.size(); ++k) {
    const auto complain = [&](const std::string& what) {
      throw io::FileError(where,
                          "the time of scan " + io::textOf(k) + ", " +
                              io::textOf(io::secondsOf(times[k])) + " s, is " + what +
                              " that of scan " + io::textOf(k - 1));
    };
    if (times[k] <= times[k - 1])
      complain("not at least 1 ns after");
    if (io::secondsOf(times[k] - times[k - 1]) > longest)
      complain("more than " + io::textOf(longest) + " s after");
  }
}

std::vector<std::int64_t>
readTimes(const TimeOptions& options, const std::vector<std::string>& scans)
{
  std::vector<std::int64_t> times;
  std::string where = "--period";
  if (options.source == "names") {
    where = "--times names";
    for (const std::string& scan : scans)
      times.push_back(timeOf(std::filesystem::path(scan).stem().string(), scan));
  }
  else if (!options.source.empty()) {
    where = options.source;
    const std::string text = io::readText(where, max_size_of_times);
    for (const std::string_view word : io::words(text))
      times.push_back(timeOf(word, where));
  }
  else
    for (std::size_t k = 0; k < scans.size(); ++k)
      times.push_back(
          timeOf(io::textOf(static_cast<double>(k) * options.period), where));
  if (times.size() != scans.size())
    throw io::FileError(where,
                        "has " + io::textOf(times.size()) + " times for " +
                            io::textOf(scans.size()) + " scans");
  requireIntervals(times, where);
  return times;
}

void
requireWithin(double value, double least, double most, const std::string& option)
{
  if (!(value >= least && value <= most))
    throw io::UsageError("--" + option + " is " + io::textOf(value) +
                         ", but must be from " + io::textOf(least) + " to " +
                         io::textOf(most));
}

/** What a registration with ICP has, and a track has not. */
void
refuseIcp(const po::variables_map& given, const Settings& settings)
{
  io::refuseOptions(given,
                    {"iterations", "reciprocal", "one-to-one", "mean"},
                    " has no meaning: a track does not run ICP");
  const Settings standard;
  if (settings.icp_iterations != standard.icp_iterations || settings.is_reciprocal ||
      settings.is_one_to_one || settings.use_mean)
    throw io::UsageError("a track does not run ICP: --iterations, --reciprocal, "
                         "--one-to-one and --mean have no meaning");
  if (settings.is_normalized || settings.are_lengths_scaled ||
      settings.is_step_size_times_points || settings.is_effective_points_source_size)
    throw io::UsageError("settings of a track must not be in units of a cloud's size "
                         "or number of points");
  if (settings.options.preset == Preset::Calibrated &&
      settings.max_distance != standard.max_distance)
    throw io::UsageError("--max-distance: preset calibrated has no largest distance of "
                         "correspondences");
}

void
check(const po::variables_map& given, const TrackCommand& command)
{
  const TrackRequest& request = command.request;
  if (command.output_folder.empty())
    throw io::UsageError("--output is needed");
  requireWithin(
      request.acceleration, min_acceleration, max_acceleration, "acceleration");
  requireWithin(request.angular_acceleration,
                min_acceleration,
                max_acceleration,
                "angular-acceleration");
  if (given.count("map") > 0)
    requireWithin(request.voxel_size, min_voxel_size, 1e6, "map");
  else if (given.count("map-scans") > 0)
    throw io::UsageError("--map-scans needs --map");
  requireWithin(request.map_scans, 1, max_map_scans, "map-scans");
  requireWithin(request.span, 1, max_map_scans, "span");
  if (request.span > 1 && request.voxel_size > 0.0)
    throw io::UsageError("--span excludes --map");
  refuseIcp(given, request.settings);
  const PriorOptions& prior = request.settings.options.prior;
  if (!prior.variance.allFinite())
    throw io::UsageError("--prior-variance must be finite: it is how well the first "
                         "motion is known");
  if (prior.frame == PriorFrame::SourceCentroid)
    throw io::UsageError("--prior-frame source-centroid: the motion of a track is that "
                         "of the sensor, whose frame is the origin");
}

const io::ToolText tool_text = {
    "pcl_bayesian_icp_track " BAYESIAN_ICP_VERSION,
    R"(Usage: pcl_bayesian_icp_track FOLDER -o FOLDER [options]
       pcl_bayesian_icp_track SCAN SCAN ... -o FOLDER [options]

Registers each scan to the one before it, or to a local map (--map), and writes
the trajectory of the sensor with its covariance. The scans of a folder are its
.pcd files, sorted by name; their points are in the frame of the sensor, in m.

The prior of each registration is a prediction with constant velocity. Its
uncertainty follows from the earlier registrations and --acceleration. --guess
and --prior-variance describe the first motion, from scan 0 to scan 1. If scan 0
lies in a plane, as that of a 2-D laser scanner does, the sensor stays in it.

If the status is not ok, the registration is repeated as if the velocity were as
unknown as at the start, and the better result is used. ICP is not run:
--iterations, --reciprocal, --one-to-one and --mean are errors, and so is
--max-distance with preset calibrated.

If a scan is registered with status doubtful, its standard deviations are
tripled ("widened"). A scan that cannot be registered, or that has the flag
wrong_basin or both low_support and misfit, gets the predicted pose
("predicted"), and the next one is registered to the same target. From the
third such scan in a row on, a scan that can be read becomes the target
("split"). Directions that the clouds do not determine are left to the
prediction.

FOLDER gets
  edges.jsonl                one line per scan: its edge without the prior, its
                             status, and its pose
  trajectory_tum.txt         time, position (m) and quaternion of each scan in
                             the frame of scan 0
  trajectory_covariance.txt  the 6x6 covariances, in ROS's convention (m, rad)
  graph.g2o                  the edges without the prior, as a pose graph; edges of
                             predicted and split scans are the prediction
  report.html                the trajectory in pictures (needs gnuplot)

For more, see docs/track.md.
)",
    R"(
Exit codes:
  0    all scans are registered, with status ok
  1    some are not, and all files have been written; or another failure
  2    wrong usage
  3    a file cannot be used or written
  130  interrupted (Ctrl-C or SIGTERM); the files have all scans so far, and the
       same command continues

Example:
  pcl_bayesian_icp_track scans -o track --period 0.1 --guess 0.5,0,0,0,0,0
)"};

} // namespace

TrackCommand
parseTrackCommand(int argc, const char* const* argv)
{
  TrackCommand command;
  TimeOptions times;
  const po::options_description options = describeOptionsOfTrack(command, times);
  const po::variables_map given =
      io::readCommandLine(argc, argv, options, "scan", tool_text);
  TrackRequest& request = command.request;
  request.scans = io::scansOf(io::optionTexts(given, "scan"));
  io::takeOptions(given, options);
  if (!times.source.empty())
    io::refuseOptions(given, {"period"}, " and --times exclude each other");
  requireWithin(times.period, shortest_interval, io::time_limit, "period");
  request.settings = settingsFrom(given);
  Options& options_of_presets = request.settings.options;
  for (double* const gate : {&options_of_presets.exact.residual.max_distance,
                             &options_of_presets.paper.max_distance})
    *gate = std::min(*gate, request.settings.max_distance);
  check(given, command);
  request.times = readTimes(times, request.scans);
  command.command = io::commandOf(argc, argv);
  return command;
}

} // namespace bayesian_icp::app
