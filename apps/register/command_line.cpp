#include "register/command_line.h"

#include "io/errors.h"
#include "io/numbers.h"
#include "register/export_options.h"
#include "register/option_descriptions.h"
#include "register/settings_options.h"

#include <vector>

namespace bayesian_icp::app {

namespace po = boost::program_options;

namespace {

void
takeClouds(const po::variables_map& given, Request& request)
{
  std::vector<std::string> clouds;
  if (given.count("cloud") > 0)
    clouds = given["cloud"].as<std::vector<std::string>>();
  if (clouds.size() < 2)
    throw io::UsageError("two clouds are needed, a source and a target");
  if (clouds.size() > 2)
    throw io::UsageError("two clouds are needed, " + io::quoted(clouds[2]) +
                         " is one too many");
  request.source_file = clouds[0];
  request.target_file = clouds[1];
}

void
takeExports(const po::variables_map& given, Request& request)
{
  request.exports = readExportOptions(given);
  if (request.exports.formats.empty() || !request.output_folder.empty())
    return;
  if (request.exports.formats.size() > 1)
    throw io::UsageError("--export: several formats need a folder, --output");
  if (request.is_json || request.is_quiet)
    throw io::UsageError(
        "--export without --output prints, which excludes --json and --quiet");
}

} // namespace

Request
parseCommandLine(int argc, const char* const* argv)
{
  const po::variables_map given =
      splitCommandLine(argc, argv, describeOptions(), "cloud");
  Request request;
  if (given.count("help") > 0 || given.count("version") > 0) {
    request.kind =
        given.count("help") > 0 ? Request::Kind::ShowHelp : Request::Kind::ShowVersion;
    return request;
  }
  takeClouds(given, request);
  request.output_folder = textOf(given, "output");
  request.is_json = given.count("json") > 0;
  request.is_quiet = given.count("quiet") > 0;
  if (request.is_json && request.is_quiet)
    throw io::UsageError("--json and --quiet exclude each other");
  takeExports(given, request);
  request.settings = settingsFrom(given, Settings(), request.note);
  return request;
}

} // namespace bayesian_icp::app
