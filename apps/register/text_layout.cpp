#include "register/text_layout.h"

#include "io/numbers.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp::app {

std::string
leftAligned(std::string text, std::size_t width)
{
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

std::string
rightAligned(const std::string& text, std::size_t width)
{
  return std::string(width > text.size() ? width - text.size() : 1, ' ') + text;
}

std::string
numberText(double value, int num_decimals, const std::string& unknown)
{
  if (!std::isfinite(value))
    return unknown;
  return std::abs(value) < 1e9 ? io::fixedTextOf(value, num_decimals)
                               : io::textOf(value, 5);
}

std::string
cell(double value, int num_decimals, std::size_t width)
{
  return rightAligned(numberText(value, num_decimals, "-"), width);
}

std::string
wrapped(const std::string& text)
{
  constexpr std::size_t max_length = 88;
  const std::string indent(8, ' ');
  std::string lines, line;
  for (const auto word : io::words(text, " ")) {
    if (line.size() + 1 + word.size() > max_length) {
      lines += line + '\n';
      line = indent + std::string(word);
    }
    else
      line += (line.empty() ? "" : " ") + std::string(word);
  }
  return lines + line + '\n';
}

} // namespace bayesian_icp::app
