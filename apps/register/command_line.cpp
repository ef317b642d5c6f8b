#include "register/command_line.h"

#include "io/errors.h"
#include "io/numbers.h"
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

/** Two different numbers from 0 on, the target's vertex and the source's. */
void
takeVertices(const std::string& text, ExportOptions& options)
{
  const auto items = io::splitAt(',', text);
  if (items.size() != 2 || !io::readNumber(items[0], options.target_vertex) ||
      !io::readNumber(items[1], options.source_vertex) || !options.validate().empty())
    refuse("vertices", text, "two different whole numbers from 0 on");
}

void
takeFrame(const po::variables_map& given,
          const std::string& option,
          std::string ExportOptions::*frame,
          ExportOptions& options)
{
  if (given.count(option) == 0)
    return;
  options.*frame = textOf(given, option);
  if (!options.validate().empty())
    refuse(option, options.*frame, "made of A-Z a-z 0-9 _ - . / only");
}

void
takeExports(const po::variables_map& given, Request& request)
{
  ExportRequest& exports = request.exports;
  for (const char* option :
       {"target-frame", "source-frame", "timestamp", "vertices", "export-unreliable"})
    if (given.count(option) > 0 && given.count("export") == 0)
      throw io::UsageError(std::string("--") + option +
                           ": has no effect without --export");
  if (given.count("export") == 0)
    return;
  exports.formats = readExportFormats(textOf(given, "export"));
  takeFrame(given, "target-frame", &ExportOptions::target_frame, exports.options);
  takeFrame(given, "source-frame", &ExportOptions::source_frame, exports.options);
  if (given.count("timestamp") > 0)
    exports.options.timestamp_ns = readTimestamp(textOf(given, "timestamp"));
  if (given.count("vertices") > 0)
    takeVertices(textOf(given, "vertices"), exports.options);
  exports.options.accept_unreliable = given.count("export-unreliable") > 0;
  if (!request.output_folder.empty())
    return;
  if (exports.formats.size() > 1)
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
