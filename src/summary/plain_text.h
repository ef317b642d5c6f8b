/** \file
 * \brief Numbers in text with a decimal point, in any locale of the program.
 */
#pragma once

#include <locale.h>

#include <clocale>
#include <cstdio>
#include <string>

namespace bayesian_icp {

/** \brief The locale "C" for this thread, as long as this object lives. */
class PlainLocale {
public:
  PlainLocale()
  {
    static const locale_t plain = newlocale(LC_ALL_MASK, "C", locale_t());
    previous_ = uselocale(plain);
  }
  ~PlainLocale() { uselocale(previous_); }
  PlainLocale(const PlainLocale&) = delete;
  PlainLocale&
  operator=(const PlainLocale&) = delete;

private:
  locale_t previous_;
};

/** \brief As `printf`; text is truncated to 400 characters. */
template <typename... Values>
std::string
formatted(const char* format, Values... values)
{
  const PlainLocale plain;
  char text[400];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

} // namespace bayesian_icp
