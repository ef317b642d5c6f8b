/** \file
 * \brief Settings from a command line, for every program that registers pairs.
 */
#pragma once

#include "register/settings.h"

#include <boost/program_options/variables_map.hpp>

#include <string>

namespace bayesian_icp::app {

/** \brief Refuse the value of an option: "--option: 'value' is not ...".
 * \throws io::UsageError */
[[noreturn]] void
refuse(const std::string& option,
       const std::string& value,
       const std::string& expected);

/** \brief What the command line, and the file that --config names, say of the settings.
 * \param[in] defaults settings if nothing is said; a --config file has its own
 * \param[out] note something that the user ought to know; empty if nothing
 * \throws io::UsageError or io::FileError naming the option or file */
Settings
settingsFrom(const boost::program_options::variables_map& given,
             const Settings& defaults,
             std::string& note);

} // namespace bayesian_icp::app
