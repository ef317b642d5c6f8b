#include "batch/batch_command.h"

#include "batch/ranks.h"
#include "io/command_line.h"
#include "register/settings_options.h"

#include <sstream>
#include <vector>

namespace bayesian_icp::app {

namespace po = boost::program_options;

namespace {

po::options_description
describeOptionsOfBatch(BatchRequest& request)
{
  po::options_description group("General");
  // clang-format off
  group.add_options()
    ("help,h", "Show this text.")
    ("version", "Show the version.")
    ("results", io::fileName("FILE", request.results_file),
     "Write the lines to this file, and skip pairs that already have a line in it. "
     "(default: standard output)")
    ("output,o", io::fileName("DIR", request.output_folder),
     "Write DIR/NAME/posterior.json and samples.csv for each pair. Without it, only "
     "the lines are written.")
    ("suggested-prior", io::flag(request.use_suggested_prior),
     "Take the prior about the guess and the source's centroid, with the standard "
     "deviations 'suggested_prior_sigma' of each pair. Without it, all pairs have the "
     "prior of --prior-mean and --prior-variance.")
    ("quiet", io::flag(request.is_quiet), "Show no progress.");
  // clang-format on
  po::options_description all;
  all.add(group);
  describeSettings(Settings(), all);
  return all;
}

void
refuseSecondPrior(const po::variables_map& given)
{
  for (const char* const name : {"prior-mean", "prior-variance", "prior-frame"})
    if (given.count(name) > 0)
      throw io::UsageError("--suggested-prior and --" + std::string(name) +
                           " exclude each other");
}

std::string
helpText(const po::options_description& options)
{
  std::ostringstream help;
  help << R"(Usage: pcl_bayesian_icp_batch MANIFEST [options]
       mpirun -n N pcl_bayesian_icp_batch MANIFEST --results FILE [options]

Registers many pairs of clouds in parallel. Prints one line of JSON for each
pair as soon as it is finished. MANIFEST is a JSON list of pairs,
  {"name": ..., "source": FILE, "target": FILE, "guess": FILE or six numbers,
   "settings": {...}}
whose files are relative to the manifest. Guess and settings are optional. The
settings have the form of the 'options' of a posterior.json. They take
precedence over the options below, which apply to all pairs. --threads is the
number of threads of the whole process: each pair has one thread if there are
more pairs than threads. docs/batch.md describes the keys of a line.

A batch that was stopped continues if it is started again with the same
--results. If a pair cannot be read or registered, its line has the status
"error", and the other pairs continue.
)" << options
       << R"(
Exit codes:
  0    the status of all pairs is "ok"
  1    the status of some pairs is not "ok"
  2    wrong usage
  3    the manifest cannot be used, or a result cannot be written
  130  interrupted (Ctrl-C or SIGTERM); the pairs under way were abandoned

Example:
  pcl_bayesian_icp_batch manifest.json --results results.jsonl \
      --prior-variance 0.01
)";
  return help.str();
}

} // namespace

std::optional<BatchRequest>
parseBatchCommand(int argc, const char* const* argv)
{
  BatchRequest request;
  const po::options_description options = describeOptionsOfBatch(request);
  const po::variables_map given = io::splitCommandLine(argc, argv, options, "manifest");
  if (io::printHelpOrVersion(
          given,
          std::string("pcl_bayesian_icp_batch " BAYESIAN_ICP_VERSION) +
              (Ranks::hasMpi() ? " with MPI" : " without MPI"),
          [&options] { return helpText(options); }))
    return std::nullopt;
  const std::vector<std::string> manifests = io::optionTexts(given, "manifest");
  if (manifests.empty())
    throw io::UsageError("expected a manifest");
  if (manifests.size() > 1)
    throw io::UsageError("expected one manifest, but got a second file: " +
                         io::inQuotes(manifests[1]));
  request.manifest_file = manifests[0];
  io::takeOptions(given, options);
  if (request.use_suggested_prior)
    refuseSecondPrior(given);
  request.settings = settingsFrom(given, Settings(), request.note);
  return request;
}

} // namespace bayesian_icp::app
