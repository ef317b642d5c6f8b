/** \file
 * \brief What the fuzzers share: the bytes of an input as a file, for readers that take
 * the name of one.
 */
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace bayesian_icp::fuzz {

/** \brief Write the input to the file \p name of a folder that lives as long as the
 * program, over what was there.
 * \return its path */
std::string
writeInput(const std::string& name, std::string_view bytes);

/** \brief Whether \p read gets through. Refusing an input by FileError or UsageError is
 * all right, any other exception goes on and ends the fuzzer. */
bool
isAccepted(const std::function<void()>& read);

/** \brief End the fuzzer, with \p what on standard error, unless \p holds. */
void
require(bool holds, const char* what);

/** \brief The bytes of an input. */
inline std::string_view
textOf(const std::uint8_t* data, std::size_t size)
{
  return {reinterpret_cast<const char*>(data), size};
}

} // namespace bayesian_icp::fuzz
