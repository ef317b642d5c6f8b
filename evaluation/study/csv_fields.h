/** \file
 * \brief Rows of CSV files without quoting: fields in turn.
 */
#pragma once

#include "io/numbers.h"

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief A row in the making. */
class CsvRow {
public:
  /** \brief Commas and control characters become spaces. */
  CsvRow&
  add(const std::string& text)
  {
    separate();
    for (const char character : text) {
      const bool is_plain =
          character != ',' && static_cast<unsigned char>(character) >= 0x20;
      text_ += is_plain ? character : ' ';
    }
    return *this;
  }

  template <typename Number>
  CsvRow&
  add(Number number)
  {
    separate();
    text_ += io::textOf(number);
    return *this;
  }

  const std::string&
  text() const
  {
    return text_;
  }

private:
  void
  separate()
  {
    if (!is_empty_)
      text_ += ',';
    is_empty_ = false;
  }

  std::string text_;
  bool is_empty_ = true;
};

/** \brief The fields of a row, read one after the other. All throw std::runtime_error
 * if the row is not as expected. */
class CsvFields {
public:
  explicit CsvFields(std::string_view line) : fields_(io::splitAt(',', line)) {}

  std::string
  text()
  {
    return std::string(next());
  }

  template <typename Number>
  void
  read(Number& number)
  {
    if (!io::readNumber(next(), number))
      throw std::runtime_error("not a number");
  }

  /** \brief Check that nothing is left. */
  void
  end() const
  {
    if (next_ != fields_.size())
      throw std::runtime_error("too many fields");
  }

private:
  std::string_view
  next()
  {
    if (next_ == fields_.size())
      throw std::runtime_error("too few fields");
    return fields_[next_++];
  }

  std::vector<std::string_view> fields_;
  std::size_t next_ = 0;
};

} // namespace bayesian_icp::evaluate
