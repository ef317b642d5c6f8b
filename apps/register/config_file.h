/** \file
 * \brief Configuration files: which layout one has, and broken JSON.
 */
#pragma once

#include "register/settings.h"

#include <optional>
#include <string>

namespace bayesian_icp::app {

/** \brief Read settings from a file: the "options" of a posterior.json, a
 * posterior.json itself, or a config.json of the authors' program. Settings that it
 * does not mention have their defaults.
 * \param[in] preset replaces that of the file; the file must have settings of it only
 * \throws io::FileError if there is no JSON in the file, io::UsageError if what it asks
 *         for is unknown, malformed or not available */
Settings
readConfigFile(const std::string& file, const std::optional<Preset>& preset);

} // namespace bayesian_icp::app
