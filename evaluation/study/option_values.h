/** \file
 * \brief Where the values of a study's options go, as the functions in
 * io/command_line.h. The default of an option is what its place has before.
 */
#pragma once

#include "io/command_line.h"

#include <cstdint>
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

/** \brief Words separated by commas. */
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

/** \brief The pieces between separators; none of an empty text. */
std::vector<std::string>
split(const std::string& text, char separator);

} // namespace bayesian_icp::evaluate
