#include "register/command_line.h"

#include "io/command_line.h"
#include "register/export_options.h"
#include "register/settings_options.h"
#include "register/sgd_request.h"

#include <sstream>

namespace bayesian_icp::app {

namespace po = boost::program_options;

namespace {

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

const char* const about_exact = R"(
Preset exact needs the truth about the sensor: --sigma, and --effective-points,
the number of independent measurements in the source.
)";

const char* const about_calibrated = R"(
Preset calibrated needs no truth about the sensor. It measures distances to the
target's surface in units of the noise that it finds there, and it accounts for
correlations between neighbouring points. It reports how well the clouds
determine the pose in each direction. Directions that they do not determine
stay at the prior, which has to be finite.
)";

std::string
helpText(const po::options_description& options)
{
  std::ostringstream help;
  help << R"(Usage: pcl_bayesian_icp SOURCE TARGET [options]

Registers a source cloud to a target cloud by ICP and samples the posterior of
the pose that maps source points into the target frame: mean, covariance,
quantiles, draws. Clouds are .pcd or .ply files in metres. Options begin with
one or two dashes; their values follow a space or '='.
)" << options
       << '\n'
       << describeSgdOptions() << about_exact << about_calibrated << aboutSgdIcp()
       << R"(
Exit codes:
  0    there is a posterior, and it can be trusted
  1    the registration failed, the chains have not mixed or are in several
       modes, the clouds call for doubt, or an export is not possible
  2    wrong usage
  3    a file cannot be read, used or written
  130  interrupted (Ctrl-C or SIGTERM); the draws until then are written

Example:
  pcl_bayesian_icp source.pcd target.pcd -d 0.1 --guess 0,0,0.2,0,0,1.57 -o out
  pcl_bayesian_icp source.pcd target.pcd --preset exact --sigma 0.005 \
      --effective-points 300 --prior-frame source-centroid
  pcl_bayesian_icp source.pcd target.pcd --prior-mean 0,0,0.2,0,0,1.57 \
      --prior-variance 0.01,0.01,0.01,0.04,0.04,0.04
)";
  return help.str();
}

} // namespace

po::options_description
describeOptions(Request& request)
{
  po::options_description general("General");
  // clang-format off
  general.add_options()
    ("help,h", "Show this text.")
    ("version", "Show the version.")
    ("method", po::value<std::string>()->value_name("NAME"),
     "Method: bayesian-icp samples the posterior, sgd-icp finds a pose only. (default "
     "bayesian-icp)")
    ("output,o", io::fileName("DIR", request.output_folder),
     "Write aligned.pcd, samples.csv, posterior.json and report.html to this folder, "
     "and make it if it is missing. report.html shows everything on one page and needs "
     "gnuplot. Without this option no file is written.")
    ("no-report", "With --output: do not write report.html.")
    ("json", io::flag(request.is_json),
     "Print the content of posterior.json instead of the table.")
    ("quiet", io::flag(request.is_quiet), "Print errors only, and show no progress bar.");
  // clang-format on
  po::options_description all;
  all.add(general).add(describeExportOptions(request.exports));
  describeSettings(Settings(), all);
  return all;
}

std::optional<Request>
parseCommandLine(int argc, const char* const* argv)
{
  Request request;
  const po::options_description options = describeOptions(request);
  // Those of SGD-ICP have been refused before, unless help is asked for.
  po::options_description all;
  all.add(options).add(describeSgdOptions());
  const po::variables_map given = io::splitCommandLine(argc, argv, all, "cloud");
  if (io::printHelpOrVersion(given,
                             "pcl_bayesian_icp " BAYESIAN_ICP_VERSION,
                             [&options] { return helpText(options); }))
    return std::nullopt;
  request.command = io::commandOf(argc, argv);
  io::takeClouds(given, "cloud", request.source_file, request.target_file);
  refuseExportOptionsWithoutExport(given);
  io::takeOptions(given, options);
  request.wants_report = given.count("no-report") == 0;
  if (!request.wants_report && request.output_folder.empty())
    throw io::UsageError("--no-report: has no effect without --output");
  if (request.is_json && request.is_quiet)
    throw io::UsageError("--json and --quiet exclude each other");
  checkExports(request);
  request.settings = settingsFrom(given, Settings(), request.note);
  return request;
}

} // namespace bayesian_icp::app
