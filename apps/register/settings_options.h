/** \file
 * \brief Settings as options of a command line, for every program that registers pairs.
 */
#pragma once

#include "register/settings.h"

#include <boost/program_options/options_description.hpp>
#include <boost/program_options/variables_map.hpp>

#include <string>

namespace bayesian_icp::app {

/** \brief Add the options that decide the result of a registration, which all programs
 * that register have in common, described with their units and defaults. Values are
 * strings. Each preset has a group, so that an option can be there several times. */
void
describeSettings(boost::program_options::options_description& options);

/** \brief What the command line, and the file that --config names, say of the settings.
 * \throws io::UsageError or io::FileError naming the option or file */
Settings
settingsFrom(const boost::program_options::variables_map& given);

} // namespace bayesian_icp::app
