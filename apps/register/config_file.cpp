#include "register/config_file.h"

#include "io/errors.h"
#include "io/json_file.h"
#include "io/posterior_file.h"
#include "register/authors_config.h"
#include "register/settings_json.h"

#include <nlohmann/json.hpp>

namespace bayesian_icp::app {

namespace {

using nlohmann::json;

constexpr std::uint64_t max_config_size = 16 << 20;

Settings
settingsWith(const std::optional<Preset>& preset, json settings)
{
  const bool is_object =
      settings.is_object() && settings.value("posterior", json::object()).is_object();
  if (preset && is_object)
    settings["posterior"]["preset"] = toString(*preset);
  return settingsOf(settings);
}

/** The settings of a posterior.json. */
Settings
settingsOfPosterior(const std::optional<Preset>& preset, const json& document)
{
  const json version = document.value("schema_version", json());
  if (document["schema"] != io::posterior_schema_name ||
      version != io::posterior_schema_version)
    throw io::UsageError("unknown schema " + io::inQuotes(document["schema"].dump()) +
                         " version " + io::inQuotes(version.dump()));
  if (!document.contains("options"))
    throw io::UsageError("the key 'options' is missing");
  return settingsWith(preset, document["options"]);
}

} // namespace

Settings
readConfigFile(const std::string& file,
               const std::optional<Preset>& preset,
               std::string& note)
{
  const json document = io::readJson(file, max_config_size);
  try {
    if (!document.is_object())
      throw io::UsageError("is not a JSON object");
    if (document.contains("schema"))
      return settingsOfPosterior(preset, document);
    if (!isAuthorsConfig(document))
      return settingsWith(preset, document);
    if (preset.value_or(Preset::Paper) != Preset::Paper)
      throw io::UsageError(std::string("is for preset paper, and the preset is ") +
                           toString(*preset));
    return settingsOfAuthorsConfig(document, note);
  }
  catch (const io::UsageError& error) {
    throw io::UsageError(file + ": " + error.what());
  }
}

} // namespace bayesian_icp::app
