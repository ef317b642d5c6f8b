#include "register/unused_settings.h"

#include "register/json_values.h"
#include "register/setting_fields.h"
#include "register/settings_json.h"

namespace bayesian_icp::app {

namespace {

/** Lists unused settings that differ from their defaults. */
struct UnusedFinder {
  Preset preset;
  nlohmann::ordered_json values;
  nlohmann::ordered_json defaults;
  std::string found;

  template <typename T>
  void
  operator()(const Field& field, const T&)
  {
    const bool is_set =
        values[field.group][field.key] != defaults[field.group][field.key];
    if (is_set && isUnused(field, preset))
      found += (found.empty() ? "" : ", ") + keyPath(field.group, field.key);
  }
};

} // namespace

bool
isUnused(const Field& field, Preset preset)
{
  const std::string group = field.group, key = field.key;
  if (key == "normalize_cloud")
    return preset != Preset::Paper;
  if (preset != Preset::Calibrated)
    return group == "calibrated";
  return group == "exact" || group == "sgld" || group == "mini_batch" ||
         (group == "posterior" && key != "preset") ||
         (group == "chains" && key == "initial_spread_m_rad");
}

std::string
unusedSettings(const Settings& settings)
{
  UnusedFinder finder{
      settings.options.preset, jsonOf(settings), jsonOf(Settings()), std::string()};
  visitSettings(settings, finder);
  return finder.found;
}

} // namespace bayesian_icp::app
