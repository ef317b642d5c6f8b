#include "html/escape.h"

#include <boost/locale/utf.hpp>

namespace bayesian_icp::html {

namespace {

const char* const replacement_character = "\xEF\xBF\xBD";

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
  namespace utf = boost::locale::utf;
  std::string result;
  const char* const end = text.data() + text.size();
  for (const char* begin = text.data(); begin != end;) {
    const char* next = begin;
    const utf::code_point code = utf::utf_traits<char>::decode(next, end);
    if (!utf::is_valid_codepoint(code)) {
      result += replacement_character;
      next = begin + 1;
    }
    else if (next == begin + 1)
      result += escapedCharacter(*begin);
    else
      result.append(begin, next);
    begin = next;
  }
  return result;
}

} // namespace bayesian_icp::html
