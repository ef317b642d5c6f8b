/** \file
 * \brief Numbers from text and to text, independent of the locale and without loss.
 */
#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace bayesian_icp::io {

/** \brief Read the number that is the whole of \p text ("nan" and "inf" are numbers if
 * \p value is a floating-point one).
 * \return whether there is one and it fits; \p value is unchanged if not */
template <typename Number>
bool
readNumber(std::string_view text, Number& value)
{
  if (text.size() > 1 && text.front() == '+' && text[1] != '-')
    text.remove_prefix(1);
  Number number{};
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size())
    return false;
  value = number;
  return true;
}

/** \brief The shortest text that reads back as the same number. */
template <typename Number>
std::string
textOf(Number value)
{
  char buffer[64];
  const auto result = std::to_chars(buffer, buffer + sizeof(buffer), value);
  return std::string(buffer, result.ptr);
}

/** \brief The value with at most \p num_digits significant digits, without trailing
 * zeros; with another \p format as many digits as that says. */
inline std::string
textOf(double value,
       int num_digits,
       std::chars_format format = std::chars_format::general)
{
  char buffer[512];
  const auto result =
      std::to_chars(buffer, buffer + sizeof(buffer), value, format, num_digits);
  return std::string(buffer, result.ptr);
}

/** \brief So many digits behind the point. */
inline std::string
fixedTextOf(double value, int num_decimals)
{
  return textOf(value, num_decimals, std::chars_format::fixed);
}

/** \brief The pieces of \p text between characters of \p separators, empty ones left
 * out. */
inline std::vector<std::string_view>
words(std::string_view text, std::string_view separators = " \t\r\n\v\f")
{
  std::vector<std::string_view> found;
  std::size_t begin = 0;
  while ((begin = text.find_first_not_of(separators, begin)) !=
         std::string_view::npos) {
    const std::size_t end = text.find_first_of(separators, begin);
    found.push_back(text.substr(begin, end - begin));
    begin = end;
  }
  return found;
}

/** \brief Lines of at most \p width characters, broken at blanks where there are any;
 * those after the first begin with \p indent. */
inline std::string
wrapped(std::string_view text, std::size_t width, const std::string& indent = "")
{
  std::string lines, line;
  bool is_first = true; // of its line
  for (const std::string_view word : words(text, " ")) {
    if (!is_first && line.size() + 1 + word.size() > width) {
      lines += line + '\n';
      line = indent;
    }
    else if (!is_first)
      line += ' ';
    line += word;
    is_first = false;
  }
  return lines + line;
}

/** \brief The pieces of \p text between separators, empty ones included. */
inline std::vector<std::string_view>
splitAt(char separator, std::string_view text)
{
  std::vector<std::string_view> pieces;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = text.find(separator, begin);
    pieces.push_back(text.substr(begin, end - begin));
    if (end == std::string_view::npos)
      return pieces;
    begin = end + 1;
  }
}

/** \brief Read \p text as so many numbers as \p values has, with separators between.
 * \return whether it is that; if not, some of \p values may have changed */
template <typename Values>
bool
readNumbers(std::string_view text, Values& values, char separator = ',')
{
  const auto items = splitAt(separator, text);
  auto value = std::begin(values);
  return std::distance(value, std::end(values)) ==
             static_cast<std::ptrdiff_t>(items.size()) &&
         std::all_of(items.begin(), items.end(), [&value](std::string_view item) {
           return readNumber(item, *value++);
         });
}

} // namespace bayesian_icp::io
