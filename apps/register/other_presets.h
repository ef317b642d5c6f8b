/** \file
 * \brief Settings that the chosen preset does not have, but another one has.
 */
#pragma once

#include "io/errors.h"
#include "register/choices.h"
#include "register/preset_fields.h"
#include "register/settings.h"

#include <string>

namespace bayesian_icp::app {

/** \brief Refuse a setting that only other presets have.
 * \param[in] name as the user calls it
 * \param[in] preset the chosen one
 * \param[in] is_it whether a Field is the setting
 * \throws io::UsageError */
template <typename Predicate>
void
refuseOfOtherPresets(const std::string& name, Preset preset, const Predicate& is_it)
{
  const Settings settings;
  std::string others;
  for (const Preset candidate : choicesOf(preset)) {
    bool has_it = false;
    auto look = [&](const Field& field, const auto&) { has_it |= is_it(field); };
    visitPreset(candidate, settings, look);
    if (has_it && candidate == preset)
      return;
    if (has_it)
      others += (others.empty() ? "" : " and ") + std::string(toString(candidate));
  }
  if (!others.empty())
    throw io::UsageError(name +
                         (others.find(' ') == std::string::npos
                              ? " belongs to preset "
                              : " belongs to presets ") +
                         others + ", and the preset is " + toString(preset));
}

} // namespace bayesian_icp::app
