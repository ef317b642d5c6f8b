#include "register/command_line.h"

#include "io/command_line.h"
#include "io/folders.h"
#include "io/time_stamps.h"
#include "register/settings_options.h"

#include <algorithm>

namespace bayesian_icp::app {

namespace po = boost::program_options;

namespace {

/** Two different numbers from 0 on, the target's vertex and the source's. */
void
takeVertices(const std::string& text, ExportOptions& options)
{
  const auto items = io::splitAt(',', text);
  if (items.size() != 2 || !io::readNumber(items[0], options.target_vertex) ||
      !io::readNumber(items[1], options.source_vertex) || !options.validate().empty())
    io::refuseValue(text, "two different whole numbers from 0 on");
}

/** Nanoseconds of a decimal number of seconds, without loss. */
void
takeTimestamp(const std::string& seconds, ExportOptions& options)
{
  if (!io::readSeconds(seconds, options.timestamp_ns) || !options.validate().empty())
    io::refuseValue(seconds,
                    "a number of seconds from 0 to below 2^31 with at most nine "
                    "decimals");
}

/** The formats of a list with commas, each once. */
void
takeFormats(const std::string& list, std::vector<std::string>& formats)
{
  for (const auto item : io::splitAt(',', list)) {
    const std::string format(item);
    if (!isExportFormat(format))
      io::refuseValue(format, export_format_names);
    if (std::find(formats.begin(), formats.end(), format) == formats.end())
      formats.push_back(format);
  }
}

/** An option that is the name of a frame. */
po::typed_value<std::string>*
frame(std::string ExportOptions::*frame, ExportOptions& options)
{
  return io::taken("NAME", [frame, &options](const std::string& name) {
    options.*frame = name;
    if (!options.validate().empty())
      io::refuseValue(name, "made of A-Z a-z 0-9 _ - . / only");
  });
}

/** The options that concern exports. They fill \p exports, which has to outlive them.
 */
po::options_description
describeExportOptions(ExportRequest& exports)
{
  ExportOptions& options = exports.options;
  const std::string formats =
      std::string("Export the posterior mean and covariance for other software: ") +
      export_format_names +
      ", separated by commas. With --output, each format becomes a file in that "
      "folder; without it, give one format, which is printed instead of the table. "
      "docs/exports.md has the conventions. Without --export nothing is exported.";
  po::options_description group("Export");
  // clang-format off
  group.add_options()
    ("export", io::taken("LIST", [&exports](const std::string& list) {
       takeFormats(list, exports.formats);
     }),
     formats.c_str())
    ("target-frame", frame(&ExportOptions::target_frame, options),
     "Name of the frame_id of ros and of the target frame of csv. (default target)")
    ("source-frame", frame(&ExportOptions::source_frame, options),
     "Name of the source frame of csv. (default source)")
    ("timestamp", io::taken("S", [&options](const std::string& seconds) {
       takeTimestamp(seconds, options);
     }),
     "Time of ros, tum and csv [s since 1970]. (default 0)")
    ("vertices", io::taken("I,J", [&options](const std::string& vertices) {
       takeVertices(vertices, options);
     }),
     "Vertices of target and source in g2o. (default 0,1)")
    ("export-without-prior", io::flag(exports.is_without_prior),
     "Export what the clouds alone determine, for a filter or graph that already "
     "contains the prior, for example as odometry.")
    ("export-unreliable", io::flag(options.accept_unreliable),
     "Also export if the status is neither ok nor doubtful. Without it, such a "
     "posterior is not exported.");
  // clang-format on
  return group;
}

void
takeClouds(const std::vector<std::string>& clouds, Request& request)
{
  if (clouds.size() < 2)
    throw io::UsageError("expected a source and a target cloud");
  if (clouds.size() > 2)
    throw io::UsageError(
        "expected one source and one target cloud, but got a third file: " +
        io::inQuotes(clouds[2]));
  request.source_file = clouds[0];
  request.target_file = clouds[1];
}

/** \throws io::UsageError if a cloud of a former run would be replaced while it is used
 */
void
refuseToReplaceInput(const Request& request)
{
  for (const std::string& file : {request.source_file, request.target_file})
    if (!request.output_folder.empty() &&
        io::isSameFile(file, request.output_folder + "/aligned.pcd"))
      throw io::UsageError("--output: " + io::inQuotes(request.output_folder) +
                           " has the input " + file +
                           ", which would be replaced; take another folder");
}

/** \throws io::UsageError if what is exported cannot be printed */
void
checkExports(const Request& request)
{
  if (request.exports.formats.empty() || !request.output_folder.empty())
    return;
  if (request.exports.formats.size() > 1)
    throw io::UsageError("--export: several formats need --output");
  if (request.is_json || request.is_quiet)
    throw io::UsageError(
        "--export without --output excludes --json and --quiet, because it prints");
}

io::ToolText
toolText()
{
  return {"pcl_bayesian_icp " BAYESIAN_ICP_VERSION,
          R"(Usage: pcl_bayesian_icp SOURCE TARGET [options]

Registers a source cloud to a target cloud by ICP and samples the posterior of
the pose that maps source points into the target frame: mean, covariance,
quantiles, draws. Clouds are .pcd or .ply files in metres. Options begin with
one or two dashes; their values follow a space or '='.
)",
          R"(
Preset exact needs facts about the sensor: --sigma, the standard deviation of a
distance, and --effective-points, the number of independent measurements in the
source.

Preset calibrated needs no facts about the sensor. It measures distances to the
surface of the other cloud in units of the noise that it finds there, and it
accounts for correlations between neighbouring points. It reports how well the
clouds determine the pose in each direction. Along directions that they do not
determine, the posterior is the prior, which has to be finite.
)" + aboutSgdIcp() +
              R"(
Exit codes, which are about the posterior, not about ICP's result:
  0    the posterior can be trusted
  1    the registration failed, the chains have not mixed or are in several
       modes, the result is doubtful, or an export is not possible
  2    wrong usage
  3    a file cannot be read, used or written
  130  interrupted (Ctrl-C or SIGTERM); the draws so far are written

Example:
  pcl_bayesian_icp source.pcd target.pcd -d 0.1 --guess 0,0,0.2,0,0,1.57 -o out
  pcl_bayesian_icp source.pcd target.pcd --preset exact --sigma 0.005 \
      --effective-points 300 --prior-frame source-centroid
  pcl_bayesian_icp source.pcd target.pcd --prior-mean 0,0,0.2,0,0,1.57 \
      --prior-variance 0.01,0.01,0.01,0.04,0.04,0.04
)"};
}

/** Every option of Bayesian ICP, described with its unit and its default. They fill
 * \p request, which has to outlive them; settingsFrom() reads the settings. */
po::options_description
describeOptions(Request& request)
{
  po::options_description general = io::generalOptions();
  // clang-format off
  general.add_options()
    ("method", po::value<std::string>()->value_name("NAME"),
     "Method: bayesian-icp samples the posterior, sgd-icp finds a pose only. (default "
     "bayesian-icp)")
    ("output,o", io::fileName("DIR", request.output_folder),
     "Write aligned.pcd, samples.csv, posterior.json and report.html to this folder, "
     "and create it if it is missing. aligned.pcd is the source in the target's frame, "
     "with the target's VIEWPOINT, so that pcl_viewer shows both in one place. "
     "report.html shows everything on one page and needs gnuplot. If there are no "
     "draws, only posterior.json is written, and the other files of an older result are "
     "removed. Without this option no file is written.")
    ("no-report", "With --output: do not write report.html.")
    ("json", io::flag(request.is_json),
     "Print the content of posterior.json instead of the table.")
    ("quiet", io::flag(request.is_quiet), "Print errors and warnings only, and show no progress bar.");
  // clang-format on
  po::options_description all;
  all.add(general).add(describeExportOptions(request.exports));
  describeSettings(all);
  all.add(describeSgdOptions());
  return all;
}

/** \throws io::UsageError if the method is unknown, or if it is bayesian-icp and there
 *         are options that only SGD-ICP has */
bool
isSgdIcpAskedFor(const po::variables_map& given)
{
  const std::string method = given.count("method") > 0
                                 ? given["method"].as<std::string>()
                                 : std::string("bayesian-icp");
  if (method == "sgd-icp")
    return true;
  if (method != "bayesian-icp")
    throw io::UsageError("--method: " + io::inQuotes(method) +
                         " is not bayesian-icp or sgd-icp");
  const po::options_description own = describeSgdOptions();
  for (const auto& option : own.options())
    io::refuseOptions(
        given, {option->long_name()}, ": has no effect with method bayesian-icp");
  return false;
}

} // namespace

Request
parseCommandLine(int argc, const char* const* argv)
{
  Request request;
  const po::options_description options = describeOptions(request);
  const po::variables_map given =
      io::readCommandLine(argc, argv, options, "cloud", toolText());
  request.command = io::commandOf(argc, argv);
  const bool is_sgd = isSgdIcpAskedFor(given);
  if (is_sgd)
    request.sgd = sgdSettingsFrom(given);
  takeClouds(io::optionTexts(given, "cloud"), request);
  if (given.count("export") == 0)
    io::refuseOptions(given,
                      {"target-frame",
                       "source-frame",
                       "timestamp",
                       "vertices",
                       "export-without-prior",
                       "export-unreliable"},
                      ": has no effect without --export");
  io::takeOptions(given, options);
  refuseToReplaceInput(request);
  request.wants_report = given.count("no-report") == 0;
  if (!request.wants_report && request.output_folder.empty())
    throw io::UsageError("--no-report: has no effect without --output");
  if (request.is_json && request.is_quiet)
    throw io::UsageError("--json and --quiet exclude each other");
  checkExports(request);
  if (!is_sgd)
    request.settings = settingsFrom(given);
  return request;
}

} // namespace bayesian_icp::app
