#include "localization/parameters.h"

#include "io/command_line.h"
#include "io/errors.h"
#include "register/settings_options.h"

#include <algorithm>
#include <array>
#include <iostream>
#include <vector>

namespace bayesian_icp::app {

namespace po = boost::program_options;

namespace {

/** What messages state, or what a localization has no use for. */
constexpr std::array<const char*, 7> excluded = {"guess",
                                                 "iterations",
                                                 "mean",
                                                 "normalize-cloud",
                                                 "prior-frame",
                                                 "prior-mean",
                                                 "prior-variance"};

/** With preset calibrated they are of ICP, which does not run. */
constexpr std::array<const char*, 3> not_of_calibrated = {
    "max-distance", "one-to-one", "reciprocal"};

/** One parameter as an argument of a command line; empty if it is false. */
std::string
argumentOf(const std::string& parameter,
           const std::string& text,
           const po::options_description& options)
{
  std::string name = parameter;
  std::replace(name.begin(), name.end(), '_', '-');
  const auto& known = options.options();
  const auto option = std::find_if(known.begin(), known.end(), [&](const auto& one) {
    return one->long_name() == name;
  });
  if (option == known.end() || parameter.find('-') != std::string::npos ||
      std::find(excluded.begin(), excluded.end(), name) != excluded.end())
    throw io::UsageError("there is no parameter " + io::inQuotes(parameter));
  if (text.empty())
    throw io::UsageError("the parameter " + parameter + " is empty");
  if ((*option)->semantic()->max_tokens() > 0)
    return "--" + name + "=" + text;
  if (text != "true" && text != "false")
    throw io::UsageError("the parameter " + parameter + " is " + io::inQuotes(text) +
                         ", but must be true or false");
  return text == "true" ? "--" + name : "";
}

} // namespace

LocalizerOptions
readParameters(const std::map<std::string, std::string>& parameters)
{
  LocalizerOptions options;
  po::options_description own, all;
  // clang-format off
  own.add_options()
    ("map-frame", io::text("", options.map_frame))
    ("cloud-frame", io::text("", options.cloud_frame))
    ("max-prior-age-s", io::number("", options.max_prior_age))
    ("prior-floor-m", io::number("", options.prior_floor.translation))
    ("prior-floor-rad", io::number("", options.prior_floor.rotation));
  // clang-format on
  all.add(own);
  describeSettings(all);

  std::vector<std::string> arguments;
  for (const auto& [name, text] : parameters) {
    const std::string argument = argumentOf(name, text, all);
    if (!argument.empty())
      arguments.push_back(argument);
  }
  const po::variables_map given = io::splitCommandLine(arguments, all, nullptr);
  io::takeOptions(given, own);
  options.settings = settingsFrom(given);
  for (const char* name : not_of_calibrated)
    if (options.settings.options.preset == Preset::Calibrated && given.count(name) > 0)
      throw io::UsageError(std::string(name) + " has no effect with preset calibrated");
  if (!options.settings.note.empty())
    std::cerr << options.settings.note << '\n';
  const std::string complaint = options.validate();
  if (!complaint.empty())
    throw io::UsageError(complaint);
  return options;
}

} // namespace bayesian_icp::app
