/** \file
 * \brief Taking the command lines of the tools apart.
 */
#pragma once

#include <boost/program_options/cmdline.hpp>
#include <boost/program_options/options_description.hpp>
#include <boost/program_options/variables_map.hpp>

#include <string>
#include <vector>

namespace bayesian_icp::io {

/** \brief No guessing: an abbreviated or misspelt option is an error. */
constexpr int option_style =
    (boost::program_options::command_line_style::unix_style |
     boost::program_options::command_line_style::allow_long_disguise) &
    ~boost::program_options::command_line_style::allow_guessing;

/** \brief Take a command line apart; options begin with one dash or two.
 * \param[in] options those of one name count once
 * \param[in] positional_name option under which the arguments without a dash are found,
 *            as a std::vector<std::string>
 * \throws io::UsageError if there is an option that is not in \p options */
boost::program_options::variables_map
splitCommandLine(int argc,
                 const char* const* argv,
                 const boost::program_options::options_description& options,
                 const char* positional_name);

/** \brief Value of an option that is a text; empty if the option is not given.
 * \throws io::UsageError if it is given empty */
std::string
optionText(const boost::program_options::variables_map& given, const std::string& name);

/** \brief All values of an option that may be given several times, or of the arguments
 * without a dash; none if it is not given. */
std::vector<std::string>
optionTexts(const boost::program_options::variables_map& given,
            const std::string& name);

/** \brief The arguments \p name as the files of a source and a target.
 * \throws io::UsageError if they are not two */
void
takeClouds(const boost::program_options::variables_map& given,
           const std::string& name,
           std::string& source_file,
           std::string& target_file);

} // namespace bayesian_icp::io
