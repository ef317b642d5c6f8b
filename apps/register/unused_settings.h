/** \file
 * \brief Settings that have no effect with the chosen preset.
 */
#pragma once

#include "register/field.h"
#include "register/settings.h"

#include <string>

namespace bayesian_icp::app {

/** \brief Whether a setting has no effect with a preset: `calibrated` finds scale,
 * steps and starts itself, and its own settings are not for the others; only `paper`
 * has an implicit scale, which normalised clouds change. */
bool
isUnused(const Field& field, Preset preset);

/** \brief The unused settings that do not have their defaults, as "group.key, ...";
 * empty if there are none. */
std::string
unusedSettings(const Settings& settings);

} // namespace bayesian_icp::app
