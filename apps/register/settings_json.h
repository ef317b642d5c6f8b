/** \file
 * \brief The project's own layout of settings: the "options" of posterior.json.
 */
#pragma once

#include "register/settings.h"

#include <nlohmann/json_fwd.hpp>

namespace bayesian_icp::app {

/** \brief Every setting of the preset, in groups; infinite numbers and an absent prior
 * mean are null. settingsOf() makes equal settings of it. */
nlohmann::ordered_json
jsonOf(const Settings& settings);

/** \brief Settings from groups of keys; what is not mentioned is as in \p defaults.
 * \throws io::UsageError naming the key if it is unknown or of another preset, or its
 * value malformed */
Settings
settingsOf(const nlohmann::json& document, const Settings& defaults = Settings());

} // namespace bayesian_icp::app
