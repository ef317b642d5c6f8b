#include "register/settings_options.h"

#include "io/command_line.h"
#include "io/motion.h"
#include "register/choices.h"
#include "register/config_file.h"
#include "register/other_presets.h"
#include "register/setting_fields.h"

#include <cmath>
#include <optional>
#include <type_traits>

namespace bayesian_icp::app {

namespace po = boost::program_options;

namespace {

using io::readValue;

std::string
described(const Field& field, double value)
{
  const std::string text = std::isfinite(value) ? io::textOf(value) : "none";
  return std::string(field.help) + " (default " + text + ")";
}

template <typename Integer>
std::enable_if_t<std::is_integral_v<Integer>, std::string>
described(const Field& field, Integer value)
{
  return std::string(field.help) + " (default " + io::textOf(value) + ")";
}

std::string
described(const Field& field, const Vector6d& value)
{
  const bool is_one_for_all = value.isConstant(value[0]);
  return field.help + (is_one_for_all ? " (default " + io::textOf(value[0]) + ")" : "");
}

std::string
described(const Field& field, const Eigen::Matrix4d&)
{
  return std::string(field.help) + " (default: identity)";
}

template <typename Choice>
std::enable_if_t<std::is_enum_v<Choice>, std::string>
described(const Field& field, Choice value)
{
  return std::string(field.help) + " One of " + namesOfChoices(value) + ". (default " +
         toString(value) + ")";
}

template <typename T>
std::string
described(const Field& field, const Automatic<T>& value)
{
  return value.isGiven() ? described(field, value.valueOr(T()))
                         : std::string(field.help) + " (default automatic)";
}

/** Makes an option of every setting. */
struct Describer {
  po::options_description& group;

  template <typename T>
  void
  operator()(const Field& field, const T& default_value)
  {
    if constexpr (std::is_same_v<T, bool>)
      group.add_options()(field.option, field.help);
    else
      group.add_options()(field.option,
                          po::value<std::string>()->value_name(field.placeholder),
                          described(field, default_value).c_str());
  }
};

/** Six numbers separated by commas, or one for all where that makes sense. */
void
readNumbers(const std::string& text, bool may_be_one, Vector6d& value)
{
  const auto items = io::splitAt(',', text);
  Vector6d numbers;
  bool is_good = items.size() == 6 || (may_be_one && items.size() == 1);
  for (std::size_t k = 0; is_good && k < 6; ++k)
    is_good = io::readNumber(items[items.size() == 1 ? 0 : k],
                             numbers[static_cast<Eigen::Index>(k)]);
  if (!is_good)
    io::refuseValue(text,
                    std::string("six numbers separated by commas") +
                        (may_be_one ? ", or one for all" : ""));
  value = numbers;
}

/** The value of an option as a setting of any type. */
template <typename T>
void
convert(const std::string& option, const std::string& text, T& value)
{
  if constexpr (std::is_same_v<T, Vector6d>)
    readNumbers(text, option != "prior-mean", value);
  else if constexpr (std::is_same_v<T, Eigen::Matrix4d>)
    value = io::readMotion(option, text);
  else if constexpr (!std::is_enum_v<T>)
    readValue(text, value);
  else if (!readChoice(text, value))
    io::refuseValue(text, namesOfChoices(value));
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
struct OptionReader {
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
      io::readOption(name,
                     [&] { convert(name, given[name].as<std::string>(), value); });
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

void
describeSettings(const Settings& defaults, po::options_description& options)
{
  po::options_description registration("Registration");
  registration.add_options()(
      "config",
      po::value<std::string>()->value_name("FILE"),
      "Read settings from a posterior.json, from its 'options' alone, or from a "
      "config.json of the authors' program. Options on the command line take "
      "precedence. Without it, all settings have their defaults.");
  Describer describe_registration{registration};
  visitRegistration(defaults, describe_registration);
  po::options_description posterior("Posterior");
  Describer describe_posterior{posterior};
  visitPosterior(defaults.options, describe_posterior);
  visitChains(defaults.options.chains, describe_posterior);
  options.add(registration).add(posterior);
  for (const Preset preset : choicesOf(Preset())) {
    po::options_description group(std::string("Preset ") + toString(preset));
    Describer describe{group};
    visitPreset(preset, defaults, describe);
    options.add(group);
  }
}

Settings
settingsFrom(const po::variables_map& given,
             const Settings& defaults,
             std::string& note)
{
  Settings settings = defaults;
  std::string config;
  std::optional<Preset> preset;
  po::options_description first;
  first.add_options()("config", io::fileName("", config));
  first.add_options()("preset", io::taken("", [&preset](const std::string& text) {
                        convert("preset", text, preset.emplace());
                      }));
  io::takeOptions(given, first);
  if (!config.empty())
    settings = readConfigFile(config, preset, note);
  OptionReader reader{given};
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
