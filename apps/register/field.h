/** \file
 * \brief How users call one setting.
 */
#pragma once

#include <limits>
#include <string>

namespace bayesian_icp::app {

/** \brief How users call one setting. */
struct Field {
  /** Object and key in a configuration file. */
  const char* group;
  const char* key;
  /** Command line option ("long" or "long,short"), placeholder of its value, help. */
  const char* option;
  const char* placeholder;
  const char* help;
  /** What `null` in a configuration file means; NaN too if it has no other meaning. */
  double null_value = std::numeric_limits<double>::quiet_NaN();
  /** Whether `null` is allowed. */
  bool is_nullable = false;
};

/** \brief The long name in Field::option. */
inline std::string
longNameOf(const Field& field)
{
  const std::string option = field.option;
  return option.substr(0, option.find(','));
}

} // namespace bayesian_icp::app
