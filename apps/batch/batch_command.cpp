#include "batch/batch_command.h"

#include "io/command_line.h"
#include "io/errors.h"
#include "register/option_descriptions.h"
#include "register/settings_options.h"

#include <sstream>
#include <vector>

namespace bayesian_icp::app {

namespace po = boost::program_options;

namespace {

po::options_description
describeOptionsOfBatch()
{
  po::options_description group("General");
  const auto text = [](const char* placeholder) {
    return po::value<std::string>()->value_name(placeholder);
  };
  group.add_options()("help,h", "show this text");
  group.add_options()("version", "show the version");
  group.add_options()("results",
                      text("FILE"),
                      "write the lines to this file, and leave out pairs that have one "
                      "there already (default: standard output)");
  group.add_options()("output,o",
                      text("DIR"),
                      "write DIR/NAME/posterior.json and samples.csv of each pair");
  group.add_options()("suggested-prior",
                      "about the guess and the source's centroid, with the standard "
                      "deviations 'suggested_prior_sigma' of each pair");
  group.add_options()("quiet", "print no progress");
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

} // namespace

BatchRequest
parseBatchCommand(int argc, const char* const* argv)
{
  const po::variables_map given =
      io::splitCommandLine(argc, argv, describeOptionsOfBatch(), "manifest");
  BatchRequest request;
  if (given.count("help") > 0 || given.count("version") > 0) {
    request.kind = given.count("help") > 0 ? BatchRequest::Kind::ShowHelp
                                           : BatchRequest::Kind::ShowVersion;
    return request;
  }
  const std::vector<std::string> manifests = io::optionTexts(given, "manifest");
  if (manifests.empty())
    throw io::UsageError("a manifest is needed");
  if (manifests.size() > 1)
    throw io::UsageError("one manifest is needed, " + io::quoted(manifests[1]) +
                         " is one too many");
  request.manifest_file = manifests[0];
  request.results_file = io::optionText(given, "results");
  request.output_folder = io::optionText(given, "output");
  request.is_quiet = given.count("quiet") > 0;
  request.use_suggested_prior = given.count("suggested-prior") > 0;
  if (request.use_suggested_prior)
    refuseSecondPrior(given);
  request.settings = settingsFrom(given, Settings(), request.note);
  return request;
}

std::string
batchHelpText()
{
  std::ostringstream help;
  help
      << "Usage: pcl_bayesian_icp_batch MANIFEST [options]\n"
         "       mpirun -n N pcl_bayesian_icp_batch MANIFEST --results FILE "
         "[options]\n\n"
         "Registers many pairs of clouds, on all processors, and tells of each in a "
         "line of\n"
         "JSON as soon as it is done. MANIFEST is a JSON list of pairs,\n"
         "  {\"name\": ..., \"source\": FILE, \"target\": FILE, \"guess\": FILE or six "
         "numbers,\n"
         "   \"settings\": {...}}\n"
         "with files relative to the manifest. The guess and the settings, which are "
         "as "
         "in the\n"
         "'options' of a posterior.json, may be left out; they come before the options "
         "here,\n"
         "which are for all pairs. --threads is the number for the whole process: with "
         "more\n"
         "pairs than that each pair has one thread. docs/batch.md has the keys of a "
         "line.\n\n"
         "A batch that was stopped, in whatever way, goes on if it is started again "
         "with the\n"
         "same --results. A pair that cannot be read or registered has a line with "
         "status\n"
         "\"error\"; the others are not concerned.\n"
      << describeOptionsOfBatch()
      << "\nExit codes:\n"
         "  0    the status of all pairs is \"ok\"\n"
         "  1    that of some is not\n"
         "  2    wrong usage\n"
         "  3    the manifest cannot be used, or a result cannot be written\n"
         "  130  interrupted (Ctrl-C or SIGTERM); pairs under way were given up\n"
         "\nExample:\n"
         "  pcl_bayesian_icp_batch manifest.json --results results.jsonl \\\n"
         "      --prior-variance 0.01\n";
  return help.str();
}

} // namespace bayesian_icp::app
