/** \file
 * \brief Settings of a table of fields as options of a command line.
 */
#pragma once

#include "io/command_line.h"
#include "io/motion.h"
#include "register/choices.h"
#include "register/field.h"

#include <bayesian_icp/options.h>

#include <cmath>
#include <string>
#include <type_traits>

namespace bayesian_icp::app {

/** \brief A default in the words of --help; empty if there are no words for it. */
template <typename T>
std::string
defaultText(const T& value)
{
  if constexpr (std::is_enum_v<T>)
    return toString(value);
  else if constexpr (std::is_same_v<T, Eigen::Matrix4d>)
    return "identity";
  else if constexpr (std::is_same_v<T, Vector6d>)
    return value.isConstant(value[0]) ? io::textOf(value[0]) : "";
  else if constexpr (std::is_same_v<T, double>)
    return std::isfinite(value) ? io::textOf(value) : "none";
  else
    return io::textOf(value);
}

template <typename T>
std::string
defaultText(const Automatic<T>& value)
{
  return value.isGiven() ? defaultText(value.valueOr(T())) : "automatic";
}

/** \brief A visitor that makes an option of every field, with its default in the help.
 * Values are strings. */
struct Describer {
  boost::program_options::options_description& group;

  template <typename T>
  void
  operator()(const Field& field, const T& default_value)
  {
    std::string help = field.help;
    if constexpr (std::is_same_v<T, bool>) {
      group.add_options()(field.option, help.c_str());
      return;
    }
    else {
      if constexpr (std::is_enum_v<T>)
        help += " One of " + namesOfChoices(default_value) + ".";
      const std::string text = defaultText(default_value);
      if (!text.empty())
        help += " (default " + text + ")";
      using boost::program_options::value;
      group.add_options()(field.option,
                          value<std::string>()->value_name(field.placeholder),
                          help.c_str());
    }
  }
};

/** \brief Read six numbers separated by commas, or one for all unless they are a pose.
 * \throws io::BadValue */
inline void
readNumbers(const std::string& text, bool is_pose, Vector6d& value)
{
  Vector6d numbers;
  double number = 0.0;
  if (!is_pose && io::readNumber(text, number))
    numbers.setConstant(number);
  else if (!io::readNumbers(text, numbers))
    io::refuseValue(text,
                    std::string("six numbers separated by commas") +
                        (is_pose ? "" : ", or one for all"));
  if (is_pose && !io::areAnglesWithinATurn(numbers))
    io::refuseValue(text, "a pose; its angles, in radians, are at most a turn");
  value = numbers;
}

/** \brief Read the text of an option as a setting of any type.
 * \throws io::BadValue, and what io::readMotion() throws */
template <typename T>
void
convert(const std::string& option, const std::string& text, T& value)
{
  if constexpr (std::is_same_v<T, Vector6d>)
    readNumbers(text, option == "prior-mean", value);
  else if constexpr (std::is_same_v<T, Eigen::Matrix4d>)
    value = io::readMotion(option, text);
  else if constexpr (!std::is_enum_v<T>)
    io::readValue(text, value);
  else if (!readChoice(text, value))
    io::refuseValue(text, namesOfChoices(value));
}

template <typename T>
void
convert(const std::string& option, const std::string& text, Automatic<T>& value)
{
  value = automatic;
  if (text == "automatic")
    return;
  T given = T();
  convert(option, text, given);
  value = given;
}

/** \brief A visitor that reads the fields that the command line has. */
struct OptionReader {
  const boost::program_options::variables_map& given;

  template <typename T>
  void
  operator()(const Field& field, T& value)
  {
    const std::string name = longNameOf(field);
    if (given.count(name) == 0)
      return;
    if constexpr (std::is_same_v<T, bool>)
      value = true;
    else
      io::readOption(name,
                     [&] { convert(name, given[name].as<std::string>(), value); });
  }
};

} // namespace bayesian_icp::app
