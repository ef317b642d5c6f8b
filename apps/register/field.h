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

/** \brief A visitor of fields that looks for the option of a complaint of validate():
 * "prior.variance[x] is ..." speaks of the key "variance_m2_rad2". */
class OptionFinder {
public:
  explicit OptionFinder(const std::string& complaint)
  : complaint_(complaint)
  , name_(complaint.substr(0, complaint.find_first_of(" [")))
  {
    name_.erase(0, name_.find('.') + 1);
  }

  template <typename T>
  void
  operator()(const Field& field, const T&)
  {
    const std::string key = field.key;
    if (key == name_ || "num_" + key == name_ || key.rfind(name_ + '_', 0) == 0)
      option_ = "--" + longNameOf(field) + ": ";
  }

  /** \brief The complaint behind its option. */
  std::string
  complaintWithOption() const
  {
    return option_ + complaint_;
  }

private:
  std::string complaint_;
  std::string name_;
  std::string option_;
};

} // namespace bayesian_icp::app
