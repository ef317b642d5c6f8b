#include "register/config_file.h"

#include "io/errors.h"
#include "io/input_file.h"
#include "register/authors_config.h"
#include "register/posterior_json.h"
#include "register/settings_json.h"

#include <nlohmann/json.hpp>

namespace bayesian_icp::app {

namespace {

using nlohmann::json;

constexpr std::uint64_t max_config_size = 16 << 20;

json
parse(const std::string& file)
{
  try {
    return json::parse(io::readText(file, max_config_size));
  }
  catch (const json::exception& error) {
    // Without the library's "[json.exception.parse_error.101] " and without bytes of
    // the file that are no text.
    std::string text = error.what();
    const std::size_t end_of_tag = text.find("] ");
    if (end_of_tag != std::string::npos)
      text.erase(0, end_of_tag + 2);
    for (char& character : text)
      if (static_cast<unsigned char>(character) >= 0x80)
        character = '?';
    throw io::FileError(file, "broken JSON: " + text);
  }
}

/** The settings of a posterior.json. */
Settings
settingsOfPosterior(const json& document)
{
  const json version = document.value("schema_version", json());
  if (document["schema"] != posterior_schema_name ||
      version != posterior_schema_version)
    throw io::UsageError("unknown schema " + io::quoted(document["schema"].dump()) +
                         " version " + io::quoted(version.dump()));
  if (!document.contains("options"))
    throw io::UsageError("the key 'options' is missing");
  return settingsOf(document["options"]);
}

} // namespace

Settings
readConfigFile(const std::string& file, std::string& note)
{
  const json document = parse(file);
  try {
    if (!document.is_object())
      throw io::UsageError("is not a JSON object");
    if (document.contains("schema"))
      return settingsOfPosterior(document);
    return isAuthorsConfig(document) ? settingsOfAuthorsConfig(document, note)
                                     : settingsOf(document);
  }
  catch (const io::UsageError& error) {
    throw io::UsageError(file + ": " + error.what());
  }
}

} // namespace bayesian_icp::app
