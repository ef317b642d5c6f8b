/** \file
 * \brief The command lines of the studies, and where the values of their options go,
 * as the functions in io/command_line.h. The default of an option is what its place has
 * before.
 */
#pragma once

#include "io/command_line.h"

#include <limits>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

constexpr int max_seed = 1000000000;

/** \brief A text with a default, which \p take gets; it may throw an io::BadValue. */
boost::program_options::typed_value<std::string>*
taken(const std::string& standard, const std::function<void(const std::string&)>& take);

/** \brief A text. */
boost::program_options::typed_value<std::string>*
text(std::string& value);

/** \brief A name of a \p kind ("file"), which is not empty. */
boost::program_options::typed_value<std::string>*
outputName(const std::string& kind, std::string& value);

/** \brief Words separated by commas, as wordsOf() takes them. */
boost::program_options::typed_value<std::string>*
list(std::vector<std::string>& words);

/** \brief A positive number up to \p most. */
boost::program_options::typed_value<double>*
positiveNumber(double& value, double most = std::numeric_limits<double>::max());

/** \brief A number of threads up to 256; 0 becomes as many as there are cores. */
boost::program_options::typed_value<int>*
threads(int& value);

/** \throws io::BadValue if the value is not within [least, most] */
void
requireWithin(int value, int least, int most);

/** \brief A whole number within [least, most]. */
template <typename Integer>
boost::program_options::typed_value<int>*
integer(Integer& value, int least, int most)
{
  return boost::program_options::value<int>()
      ->default_value(static_cast<int>(value))
      ->notifier([&value, least, most](int number) {
        requireWithin(number, least, most);
        value = static_cast<Integer>(number);
      });
}

/** \brief The words between commas, each once; empty ones do not count. */
std::vector<std::string>
wordsOf(const std::string& list);

/** \throws io::BadValue with the known names, of one asked for that is none of them */
void
requireKnown(const std::vector<std::string>& asked,
             const std::vector<std::string>& known);

/** \brief Where the rows of a study go, and what is made of them. */
struct ResultOptions {
  std::string file;
  bool has_report = false;

  /** \brief Make the report if it is asked for, see makeReport().
   * \return the exit code: 0, or 3 without a report */
  int
  report() const;
};

/** \brief Add --output, --report and --help to \p description.
 * \param[in] file_help of --output */
void
addResultOptions(ResultOptions& result,
                 boost::program_options::options_description& description,
                 const char* file_help =
                     "CSV file of the results, one row for each run. Runs that it "
                     "already has are skipped; a file of another version is refused");

/** \brief Read a command line, and fill the places of its options.
 * \param[in] help is printed before the options if it is asked for
 * \param[in] positional_name as in io::splitCommandLine()
 * \return what is given
 * \throws io::UsageError with a message for the user, io::Answered if it is help that
 * is asked for */
boost::program_options::variables_map
readOptions(int argc,
            const char* const* argv,
            const boost::program_options::options_description& description,
            const std::string& help,
            const char* positional_name = nullptr);

} // namespace bayesian_icp::evaluate
