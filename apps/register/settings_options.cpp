#include "register/settings_options.h"

#include "io/command_line.h"
#include "io/errors.h"
#include "io/motion.h"
#include "io/numbers.h"
#include "register/choices.h"
#include "register/config_file.h"
#include "register/other_presets.h"
#include "register/setting_fields.h"

#include <optional>

namespace bayesian_icp::app {

namespace po = boost::program_options;

void
refuse(const std::string& option, const std::string& value, const std::string& expected)
{
  throw io::UsageError("--" + option + ": " + io::quoted(value) + " is not " +
                       expected);
}

namespace {

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

/** Six numbers separated by commas, or one for all where that makes sense. */
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
           std::string("six numbers separated by commas") +
               (may_be_one ? ", or one for all" : ""));
  value = numbers;
}

void
convert(const std::string&, const std::string& text, Eigen::Matrix4d& value)
{
  value = io::readMotion("guess", text);
}

template <typename Choice>
void
convert(const std::string& option, const std::string& text, Choice& value)
{
  if (!readChoice(text, value))
    refuse(option, text, namesOfChoices(value));
}

template <typename T>
void
convert(const std::string& option, const std::string& text, Automatic<T>& value)
{
  value = automatic;
  if (text == "automatic")
    return;
  T given = T();
  convert(option, text, given);
  value = given;
}

/** Reads the settings that the command line has. */
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

} // namespace

Settings
settingsFrom(const po::variables_map& given,
             const Settings& defaults,
             std::string& note)
{
  Settings settings = defaults;
  const std::string config = io::optionText(given, "config");
  std::optional<Preset> preset;
  if (given.count("preset") > 0)
    convert("preset", given["preset"].as<std::string>(), preset.emplace());
  if (!config.empty())
    settings = readConfigFile(config, preset, note);
  SettingsReader reader{given};
  visitSettings(settings, reader);
  if (settings.are_lengths_scaled)
    refuseLengths(given, config);
  if (given.count("step-size") > 0)
    settings.is_step_size_times_points = false;
  if (given.count("effective-points") > 0)
    settings.is_effective_points_source_size = false;
  for (const auto& option : given)
    refuseOfOtherPresets(
        "--" + option.first, settings.options.preset, [&option](const Field& field) {
          return option.first == longNameOf(field);
        });
  const std::string complaint = settings.validate();
  if (!complaint.empty())
    throw io::UsageError(complaint);
  return settings;
}

} // namespace bayesian_icp::app
