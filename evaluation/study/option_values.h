/** \file
 * \brief Reading the options of a sub-command.
 */
#pragma once

#include <boost/program_options/options_description.hpp>
#include <boost/program_options/value_semantic.hpp>
#include <boost/program_options/variables_map.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief A text option and its default. */
boost::program_options::typed_value<std::string>*
textOption(const char* standard);

/** \brief An int option and its default. */
boost::program_options::typed_value<int>*
intOption(int standard);

/** \brief Read a command line without guessing: an abbreviated or misspelt option, or a
 * word that is none, is an error.
 * \throws boost::program_options::error */
boost::program_options::variables_map
readCommandLine(int argc,
                const char* const* argv,
                const boost::program_options::options_description& options);

/** \brief The pieces between separators; none of an empty text. */
std::vector<std::string>
split(const std::string& text, char separator);

/** \brief The value of an int option.
 * \throws io::UsageError if it is not within [least, most] */
int
integerWithin(const boost::program_options::variables_map& given,
              const std::string& name,
              int least,
              int most);

/** \brief The value of the option `name` as a seed. */
std::uint64_t
seedOf(const boost::program_options::variables_map& given, const std::string& name);

/** \brief The value of the option `threads`, as many as there are cores for 0. */
int
numThreadsOf(const boost::program_options::variables_map& given);

} // namespace bayesian_icp::evaluate
