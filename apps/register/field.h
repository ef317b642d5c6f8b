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

/** \brief "group.key", as in a configuration file. */
inline std::string
pathOf(const Field& field)
{
  return std::string(field.group) + '.' + field.key;
}

/** \brief A complaint of validate() behind the option that it is about:
 * "prior.variance[x] is ..." speaks of the key "variance_m2_rad2".
 * \param[in] visit_fields passes all fields to the visitor that it gets */
template <typename VisitFields>
std::string
complaintWithOption(const std::string& complaint, const VisitFields& visit_fields)
{
  std::string name = complaint.substr(0, complaint.find_first_of(" ["));
  name.erase(0, name.find('.') + 1);
  std::string option;
  visit_fields([&](const Field& field, const auto&) {
    const std::string key = field.key;
    if (key == name || "num_" + key == name || key.rfind(name + '_', 0) == 0)
      option = "--" + longNameOf(field) + ": ";
  });
  return option + complaint;
}

} // namespace bayesian_icp::app
