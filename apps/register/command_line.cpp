#include "register/command_line.h"

#include "io/errors.h"
#include "io/numbers.h"
#include "register/choices.h"
#include "register/config_file.h"
#include "register/export_options.h"
#include "register/guess.h"
#include "register/option_descriptions.h"
#include "register/setting_fields.h"
#include "register/unused_settings.h"

#include <boost/program_options.hpp>

#include <vector>

namespace bayesian_icp::app {

namespace po = boost::program_options;

namespace {

[[noreturn]] void
refuse(const std::string& option, const std::string& value, const std::string& expected)
{
  throw io::UsageError("--" + option + ": " + io::quoted(value) + " is not " +
                       expected);
}

void
convert(const std::string& option, const std::string& text, double& value)
{
  if (!io::readNumber(text, value))
    refuse(option, text, "a number");
}

template <typename Integer>
void
convertInteger(const std::string& option, const std::string& text, Integer& value)
{
  if (!io::readNumber(text, value))
    refuse(option, text, "a whole number in its range");
}

void
convert(const std::string& option, const std::string& text, int& value)
{
  convertInteger(option, text, value);
}

void
convert(const std::string& option, const std::string& text, std::uint64_t& value)
{
  convertInteger(option, text, value);
}

/** Six numbers with commas between, or where it makes sense one for all. */
void
convert(const std::string& option, const std::string& text, Vector6d& value)
{
  const bool may_be_one = option != "prior-mean";
  const auto items = io::splitAt(',', text);
  Vector6d numbers;
  bool is_good = items.size() == 6 || (may_be_one && items.size() == 1);
  for (std::size_t k = 0; is_good && k < 6; ++k)
    is_good = io::readNumber(items[items.size() == 1 ? 0 : k],
                             numbers[static_cast<Eigen::Index>(k)]);
  if (!is_good)
    refuse(option,
           text,
           std::string("six numbers with commas between") +
               (may_be_one ? ", or one for all" : ""));
  value = numbers;
}

void
convert(const std::string&, const std::string& text, Eigen::Matrix4d& value)
{
  value = readGuess(text);
}

template <typename Choice>
void
convert(const std::string& option, const std::string& text, Choice& value)
{
  if (!readChoice(text, value))
    refuse(option, text, namesOfChoices(value));
}

/** Takes over what the command line says of the settings. */
struct SettingsReader {
  const po::variables_map& given;

  template <typename T>
  void
  operator()(const Field& field, T& value)
  {
    const std::string name = longNameOf(field);
    if (given.count(name) == 0)
      return;
    if constexpr (std::is_same_v<T, bool>)
      value = true;
    else
      convert(name, given[name].as<std::string>(), value);
  }
};

/** Refuses options that have no effect with the preset. */
struct UnusedOptionRefuser {
  const po::variables_map& given;
  Preset preset;

  template <typename T>
  void
  operator()(const Field& field, const T&) const
  {
    const std::string name = longNameOf(field);
    if (given.count(name) > 0 && isUnused(field, preset))
      throw io::UsageError("--" + name + ": has no effect with preset " +
                           toString(preset));
  }
};

po::variables_map
splitCommandLine(int argc, const char* const* argv)
{
  namespace style = po::command_line_style;
  // No guessing: an abbreviated or misspelt option is an error.
  const int accepted =
      (style::unix_style | style::allow_long_disguise) & ~style::allow_guessing;
  po::options_description all = describeOptions();
  all.add_options()("cloud", po::value<std::vector<std::string>>());
  po::positional_options_description positional;
  positional.add("cloud", -1);
  po::variables_map given;
  try {
    po::store(po::command_line_parser(argc, argv)
                  .options(all)
                  .positional(positional)
                  .style(accepted)
                  .run(),
              given);
  }
  catch (const po::error& error) {
    throw io::UsageError(error.what());
  }
  return given;
}

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

std::string
textOf(const po::variables_map& given, const std::string& name)
{
  if (given.count(name) == 0)
    return "";
  auto text = given[name].as<std::string>();
  if (text.empty())
    throw io::UsageError("--" + name + ": the name is empty");
  return text;
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

/** They would be in other units than those of the file. */
void
refuseLengths(const po::variables_map& given, const std::string& config)
{
  for (const char* option :
       {"guess", "max-distance", "prior-mean", "prior-variance", "initial-spread"})
    if (given.count(option) > 0)
      throw io::UsageError(std::string("--") + option +
                           ": is in metres, but with normalize-cloud the lengths of " +
                           config + " are in units of the clouds");
}

void
takeSettings(const po::variables_map& given, Request& request)
{
  const std::string config = textOf(given, "config");
  if (!config.empty())
    request.settings = readConfigFile(config, request.note);
  SettingsReader reader{given};
  visitSettings(request.settings, reader);
  if (request.settings.are_lengths_scaled)
    refuseLengths(given, config);
  if (given.count("step-size") > 0)
    request.settings.is_step_size_times_points = false;
  if (given.count("effective-points") > 0)
    request.settings.is_effective_points_source_size = false;
  const std::string complaint = request.settings.validate();
  if (!complaint.empty())
    throw io::UsageError(complaint);
  const UnusedOptionRefuser refuser{given, request.settings.options.preset};
  visitSettings(request.settings, refuser);
  const std::string unused = unusedSettings(request.settings);
  if (!unused.empty())
    request.note += (request.note.empty() ? "" : "; ") + unused +
                    ": no effect with preset " +
                    toString(request.settings.options.preset);
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
  const po::variables_map given = splitCommandLine(argc, argv);
  Request request;
  request.command = commandOf(argc, argv);
  if (given.count("help") > 0 || given.count("version") > 0) {
    request.kind =
        given.count("help") > 0 ? Request::Kind::ShowHelp : Request::Kind::ShowVersion;
    return request;
  }
  takeClouds(given, request);
  request.output_folder = textOf(given, "output");
  request.wants_report = given.count("no-report") == 0;
  if (!request.wants_report && request.output_folder.empty())
    throw io::UsageError("--no-report: has no effect without --output");
  request.is_json = given.count("json") > 0;
  request.is_quiet = given.count("quiet") > 0;
  if (request.is_json && request.is_quiet)
    throw io::UsageError("--json and --quiet exclude each other");
  takeExports(given, request);
  takeSettings(given, request);
  return request;
}

} // namespace bayesian_icp::app
