/** \file
 * \brief What is wrong with options, in words.
 */
#pragma once

#include <cmath>
#include <locale>
#include <sstream>
#include <string>

namespace bayesian_icp {

/** \brief The first complaint of a series of checks. */
class Checker {
public:
  template <typename T>
  void
  require(bool is_good, const char* field, const T& value, const char* allowed)
  {
    if (is_good || !complaint_.empty())
      return;
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << field << " is " << value << ", but must be " << allowed;
    complaint_ = text.str();
  }

  void
  positive(const char* field, double value, const char* unit = "")
  {
    const std::string allowed = std::string("positive and finite") + unit;
    require(value > 0.0 && std::isfinite(value), field, value, allowed.c_str());
  }

  void
  atLeast(const char* field, int value, int minimum)
  {
    const std::string allowed = "at least " + std::to_string(minimum);
    require(value >= minimum, field, value, allowed.c_str());
  }

  /** \param[in] type the enumeration's name, of whose values toString() knows all */
  template <typename Enumeration>
  void
  oneOf(const char* type, const char* field, Enumeration value)
  {
    const std::string allowed = std::string("one of ") + type;
    require(toString(value) != std::string("unknown"),
            field,
            static_cast<int>(value),
            allowed.c_str());
  }

  const std::string&
  complaint() const
  {
    return complaint_;
  }

private:
  std::string complaint_;
};

} // namespace bayesian_icp
