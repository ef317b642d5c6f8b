/** \file
 * \brief Fuzzes the options in JSON: configuration files, and manifests of batches and
 * data sets.
 */
#include "batch/manifest.h"
#include "fuzz_input.h"
#include "register/config_file.h"
#include "register/settings_json.h"
#include "study/scan_pairs.h"

#include <nlohmann/json.hpp>

namespace {

using namespace bayesian_icp;

void
checkSettings(app::Settings settings)
{
  if (!settings.validate().empty())
    return;
  settings.scaleToClouds(100, 2.0);
  const std::string text = app::jsonOf(settings).dump();
  const app::Settings again = app::settingsOf(nlohmann::json::parse(text));
  fuzz::require(app::jsonOf(again).dump() == text, "settings are read back as written");
}

} // namespace

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  const std::string file =
      fuzz::writeInput(evaluate::manifest_name, fuzz::textOf(data, size));
  app::Settings settings;
  if (fuzz::isAccepted([&] { settings = app::readConfigFile(file, std::nullopt); }))
    checkSettings(settings);
  for (const bool use_suggested_prior : {false, true})
    fuzz::isAccepted([&] {
      for (const app::BatchPair& pair :
           app::readManifest(file, app::Settings(), use_suggested_prior))
        checkSettings(pair.settings);
    });
  fuzz::isAccepted(
      [&] { evaluate::readManifest(file.substr(0, file.find_last_of('/'))); });
  return 0;
}
