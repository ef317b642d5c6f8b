#include "html/escape.h"

#include <cstdint>

namespace bayesian_icp::html {

namespace {

const char* const replacement_character = "\xEF\xBF\xBD";

/** Number of bytes of the UTF-8 character at the front of \p text; 0 if there is none
 * (RFC 3629: no longer form than needed, no surrogate, at most U+10FFFF). */
std::size_t
lengthOfCharacter(std::string_view text)
{
  const auto byte = [&text](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i]));
  };
  const std::uint32_t first = byte(0);
  if (first < 0x80)
    return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length)
    return 0;
  std::uint32_t code = first & (0x7Fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80)
      return 0;
    code = code << 6 | (byte(i) & 0x3F);
  }
  const std::uint32_t least = length == 4 ? 0x10000 : length == 3 ? 0x800 : 0x80;
  const bool is_surrogate = code >= 0xD800 && code <= 0xDFFF;
  return code < least || code > 0x10FFFF || is_surrogate ? 0 : length;
}

std::string
escapedCharacter(char character)
{
  switch (character) {
  case '&':
    return "&amp;";
  case '<':
    return "&lt;";
  case '>':
    return "&gt;";
  case '"':
    return "&quot;";
  case '\'':
    return "&#39;";
  case '\t':
  case '\n':
    return std::string(1, character);
  default:
    const bool is_control =
        static_cast<unsigned char>(character) < 0x20 || character == 0x7F;
    return is_control ? replacement_character : std::string(1, character);
  }
}

} // namespace

std::string
escaped(std::string_view text)
{
  std::string result;
  while (!text.empty()) {
    const std::size_t length = lengthOfCharacter(text);
    if (length == 0)
      result += replacement_character;
    else if (length == 1)
      result += escapedCharacter(text.front());
    else
      result += text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return result;
}

} // namespace bayesian_icp::html
