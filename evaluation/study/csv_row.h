/** \file
 * \brief Rows of CSV files without quoting.
 */
#pragma once

#include "io/numbers.h"

#include <string>
#include <type_traits>

namespace bayesian_icp::evaluate {

/** \brief A row in the making. */
class CsvRow {
public:
  /** \brief Add a field. Commas and control characters of a text become spaces; a bool
   * is 0 or 1. */
  template <typename Value>
  CsvRow&
  add(const Value& value)
  {
    if (!is_empty_)
      text_ += ',';
    is_empty_ = false;
    if constexpr (std::is_same_v<Value, bool>)
      text_ += value ? '1' : '0';
    else if constexpr (std::is_arithmetic_v<Value>)
      text_ += io::textOf(value);
    else
      addText(value);
    return *this;
  }

  const std::string&
  text() const
  {
    return text_;
  }

private:
  void
  addText(const std::string& text)
  {
    for (const char character : text) {
      const bool is_plain =
          character != ',' && static_cast<unsigned char>(character) >= 0x20;
      text_ += is_plain ? character : ' ';
    }
  }

  std::string text_;
  bool is_empty_ = true;
};

} // namespace bayesian_icp::evaluate
