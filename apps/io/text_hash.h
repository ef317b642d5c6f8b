/** \file
 * \brief A number that differs from text to text.
 */
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace bayesian_icp::io {

/** \brief The hash of no text. */
constexpr std::uint64_t hash_of_nothing = 14695981039346656037u;

/** \brief 64 bit FNV-1a: the same on every machine. Not for protection from malice.
 * \param[in] hash of what is before \p text */
inline std::uint64_t
hashOf(std::string_view text, std::uint64_t hash = hash_of_nothing)
{
  for (const char character : text) {
    hash ^= static_cast<unsigned char>(character);
    hash *= 1099511628211u;
  }
  return hash;
}

/** \brief A hash as 16 hexadecimal digits. */
inline std::string
textOfHash(std::uint64_t hash)
{
  std::string text(16, '0');
  for (int k = 15; k >= 0; --k, hash >>= 4)
    text[static_cast<std::size_t>(k)] = "0123456789abcdef"[hash & 15];
  return text;
}

} // namespace bayesian_icp::io
