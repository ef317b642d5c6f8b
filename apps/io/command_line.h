/** \file
 * \brief Reading the command lines of all tools.
 *
 * A tool states each option once, in the notation of Boost.Program_options: its name,
 * what takes its value, and its help. The functions below that return a value semantic
 * say where a value goes. takeOptions() then fills these places.
 */
#pragma once

#include "io/errors.h"
#include "io/numbers.h"

#include <boost/program_options/cmdline.hpp>
#include <boost/program_options/options_description.hpp>
#include <boost/program_options/value_semantic.hpp>
#include <boost/program_options/variables_map.hpp>

#include <functional>
#include <string>
#include <type_traits>
#include <vector>

namespace bayesian_icp::io {

/** \brief No guessing: an abbreviated or misspelt option is an error. */
constexpr int option_style =
    (boost::program_options::command_line_style::unix_style |
     boost::program_options::command_line_style::allow_long_disguise) &
    ~boost::program_options::command_line_style::allow_guessing;

/** \brief Take a command line apart; options begin with one dash or two.
 * \param[in] arguments all but the program's name
 * \param[in] options those of one name count once
 * \param[in] positional_name option under which the arguments without a dash are found,
 *            as a std::vector<std::string>; null: there may be none
 * \throws io::UsageError if there is an option that is not in \p options */
boost::program_options::variables_map
splitCommandLine(const std::vector<std::string>& arguments,
                 const boost::program_options::options_description& options,
                 const char* positional_name);

/** \brief Put the values of the given options where \p options says, in the order of
 * \p options. Defaults count as given.
 * \throws UsageError that names the option if a text is not a value of it */
void
takeOptions(const boost::program_options::variables_map& given,
            const boost::program_options::options_description& options);

/** \brief Refuse options that are of no use with others.
 * \throws UsageError "--OPTION REASON" of the first of \p options that is given */
void
refuseOptions(const boost::program_options::variables_map& given,
              const std::vector<std::string>& options,
              const std::string& reason);

/** \brief What a tool says of itself. */
struct ToolText {
  /** For --version: its name and version. */
  std::string version;
  /** For --help: what stands before the options, and behind them. */
  std::string usage;
  std::string end;
};

/** \brief The group of options that all tools have: --help and --version. */
boost::program_options::options_description
generalOptions();

/** \brief splitCommandLine(), and print help or version if the command line asks for
 * it.
 * \throws Answered if it does */
boost::program_options::variables_map
readCommandLine(int argc,
                const char* const* argv,
                const boost::program_options::options_description& options,
                const char* positional_name,
                const ToolText& tool);

/** \brief A command line as a shell takes it. */
std::string
commandOf(int argc, const char* const* argv);

/** \brief Why a text is not a value of its option; follows the option's name. */
struct BadValue : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/** \throws BadValue: "'text' is not EXPECTED" */
[[noreturn]] void
refuseValue(const std::string& text, const std::string& expected);

/** \brief Run \p read, which reads the value of \p option.
 * \throws UsageError that names the option in place of a BadValue */
template <typename Read>
void
readOption(const std::string& option, const Read& read)
{
  try {
    read();
  }
  catch (const BadValue& error) {
    throw UsageError("--" + option + error.what());
  }
}

/** \brief Read the number that is the whole of \p text.
 * \throws BadValue */
template <typename Number>
void
readValue(const std::string& text, Number& value)
{
  if (!readNumber(text, value))
    refuseValue(
        text, std::is_integral_v<Number> ? "a whole number in its range" : "a number");
}

/** \brief An option whose text \p take gets, which may throw a BadValue. */
boost::program_options::typed_value<std::string>*
taken(const char* placeholder, const std::function<void(const std::string&)>& take);

/** \brief An option that is a text. */
boost::program_options::typed_value<std::string>*
text(const char* placeholder, std::string& value);

/** \brief An option that names a file or a folder, and is not empty. */
boost::program_options::typed_value<std::string>*
fileName(const char* placeholder, std::string& value);

/** \brief An option that is a number. */
template <typename Number>
boost::program_options::typed_value<std::string>*
number(const char* placeholder, Number& value)
{
  return taken(placeholder,
               [&value](const std::string& text) { readValue(text, value); });
}

/** \brief An option without a value; \p value becomes true if it is given. */
boost::program_options::typed_value<bool>*
flag(bool& value);

/** \brief All values of an option that may be given several times, or of the arguments
 * without a dash; none if it is not given. */
std::vector<std::string>
optionTexts(const boost::program_options::variables_map& given,
            const std::string& name);

} // namespace bayesian_icp::io
