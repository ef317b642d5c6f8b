#include "register/command_line.h"

#include "io/command_line.h"
#include "io/errors.h"
#include "io/numbers.h"
#include "register/export_options.h"
#include "register/option_descriptions.h"
#include "register/settings_options.h"
#include "register/sgd_request.h"

#include <vector>

namespace bayesian_icp::app {

namespace po = boost::program_options;

namespace {

void
takeExports(const po::variables_map& given, Request& request)
{
  request.exports = readExportOptions(given);
  if (request.exports.formats.empty() || !request.output_folder.empty())
    return;
  if (request.exports.formats.size() > 1)
    throw io::UsageError("--export: several formats need --output");
  if (request.is_json || request.is_quiet)
    throw io::UsageError(
        "--export without --output excludes --json and --quiet, because it prints");
}

/** An argument as a shell takes it back. */
std::string
quotedForShell(const std::string& argument)
{
  const char* harmless = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                         "0123456789_@%+=:,./-";
  if (!argument.empty() && argument.find_first_not_of(harmless) == std::string::npos)
    return argument;
  std::string quoted = "'";
  for (const char character : argument)
    quoted += character == '\'' ? std::string("'\\''") : std::string(1, character);
  return quoted + '\'';
}

std::string
commandOf(int argc, const char* const* argv)
{
  std::string command;
  for (int i = 0; i < argc; ++i)
    command += (i > 0 ? " " : "") + quotedForShell(argv[i]);
  return command;
}

} // namespace

Request
parseCommandLine(int argc, const char* const* argv)
{
  po::options_description all = describeOptions();
  all.add(describeSgdOptions()); // refused before, unless help is asked for
  const po::variables_map given = io::splitCommandLine(argc, argv, all, "cloud");
  Request request;
  request.command = commandOf(argc, argv);
  if (given.count("help") > 0 || given.count("version") > 0) {
    request.kind =
        given.count("help") > 0 ? Request::Kind::ShowHelp : Request::Kind::ShowVersion;
    return request;
  }
  io::takeClouds(given, "cloud", request.source_file, request.target_file);
  request.output_folder = io::optionText(given, "output");
  request.wants_report = given.count("no-report") == 0;
  if (!request.wants_report && request.output_folder.empty())
    throw io::UsageError("--no-report: has no effect without --output");
  request.is_json = given.count("json") > 0;
  request.is_quiet = given.count("quiet") > 0;
  if (request.is_json && request.is_quiet)
    throw io::UsageError("--json and --quiet exclude each other");
  takeExports(given, request);
  request.settings = settingsFrom(given, Settings(), request.note);
  return request;
}

} // namespace bayesian_icp::app
