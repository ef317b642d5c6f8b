/** \file
 * \brief Settings from a command line, for every program that registers pairs.
 */
#pragma once

#include "register/settings.h"

#include <boost/program_options/options_description.hpp>
#include <boost/program_options/variables_map.hpp>

#include <string>

namespace bayesian_icp::app {

/** \brief Refuse the value of an option: "--option: 'value' is not ...".
 * \throws io::UsageError */
[[noreturn]] void
refuse(const std::string& option,
       const std::string& value,
       const std::string& expected);

/** \brief Take a command line apart; options begin with one dash or two.
 * \param[in] positional_name option under which the arguments without a dash are found,
 *            as a std::vector<std::string>
 * \throws io::UsageError if there is an option that is not in \p options */
boost::program_options::variables_map
splitCommandLine(int argc,
                 const char* const* argv,
                 boost::program_options::options_description options,
                 const char* positional_name);

/** \brief Value of an option that is a text; empty if the option is not given.
 * \throws io::UsageError if it is given empty */
std::string
textOf(const boost::program_options::variables_map& given, const std::string& name);

/** \brief What the command line, and the file that --config names, say of the settings.
 * \param[in] defaults settings if nothing is said; a --config file has its own
 * \param[out] note something that the user ought to know; empty if nothing
 * \throws io::UsageError or io::FileError naming the option or file */
Settings
settingsFrom(const boost::program_options::variables_map& given,
             const Settings& defaults,
             std::string& note);

} // namespace bayesian_icp::app
