/** \file
 * \brief What a tool tells its user before it ends; the type decides the exit code.
 */
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

namespace bayesian_icp::io {

/** \brief The tool was asked for something that it does not understand or have. */
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/** \brief The tool was asked about itself, for example for its help, and has answered:
 * there is nothing more to do. */
struct Answered {};

/** \brief A file cannot be read, used or written; the message names it and the reason.
 */
struct FileError : std::runtime_error {
  FileError(const std::string& file, const std::string& reason)
  : std::runtime_error((file.empty() ? "empty file name" : file) + ": " + reason)
  {}
};

/** \brief Why a file was not written. \param[in] error value of errno, 0 if unknown */
inline std::string
reasonNotWritten(int error)
{
  return "cannot be written: " +
         (error != 0 ? std::generic_category().message(error) : "unknown error");
}

/** \brief A piece of a file or of the command line in quotes, fit for a terminal: not
 * too long, and without control characters. */
inline std::string
inQuotes(std::string_view text)
{
  constexpr std::size_t max_length = 60;
  std::string shown(text.substr(0, max_length));
  for (char& character : shown)
    if (static_cast<unsigned char>(character) < 0x20 || character == 0x7f)
      character = '?';
  return '\'' + shown + (text.size() > max_length ? "...'" : "'");
}

} // namespace bayesian_icp::io
