/** \file
 * \brief Opening a file to read, with an answer to why that does not work.
 */
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace bayesian_icp::io {

/** \brief Longest line of a cloud file that is read [bytes]. */
constexpr std::size_t max_line_length = 1 << 16;

/** \brief A regular, non-empty file, opened for reading in binary mode. */
struct InputFile {
  std::string name;
  std::uint64_t size;
  std::ifstream stream;

  /** \brief Bytes from the reading position to the end. */
  std::uint64_t
  numBytesLeft();

  /** \brief Read up to the next line break, or the end of the file.
   * \return false if nothing is left, or if the line is longer than max_line_length */
  bool
  readLine(std::string& line);
};

/** \brief Open \p name.
 * \throws FileError if it is missing, not a regular file, empty or not readable */
InputFile
openInput(const std::string& name);

/** \brief The whole of a text file.
 * \throws FileError also if it is larger than \p max_size bytes */
std::string
readText(const std::string& name, std::uint64_t max_size);

/** \brief Differs if the size or the modification time of one of the files does; empty
 * if one is missing. */
std::string
stateOf(const std::vector<std::string>& files);

} // namespace bayesian_icp::io
