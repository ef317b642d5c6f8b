#include "io/input_file.h"

#include "io/errors.h"
#include "io/text_hash.h"

#include <cerrno>
#include <filesystem>
#include <system_error>

namespace bayesian_icp::io {

namespace fs = std::filesystem;

std::uint64_t
InputFile::numBytesLeft()
{
  const auto position = stream.tellg();
  return position < 0 ? 0 : size - static_cast<std::uint64_t>(position);
}

bool
InputFile::readLine(std::string& line)
{
  line.clear();
  char character;
  while (stream.get(character)) {
    if (character == '\n')
      return true;
    if (line.size() == max_line_length)
      return false;
    line.push_back(character);
  }
  stream.clear(stream.rdstate() & ~std::ios::failbit);
  return !line.empty();
}

InputFile
openInput(const std::string& name)
{
  std::error_code error;
  const fs::file_status status = fs::status(name, error);
  if (status.type() == fs::file_type::not_found)
    throw FileError(name, "no such file");
  if (error)
    throw FileError(name, error.message());
  if (fs::is_directory(status))
    throw FileError(name, "is a directory");
  if (!fs::is_regular_file(status))
    throw FileError(name, "is not a regular file");

  InputFile file{name, fs::file_size(name, error), {}};
  if (error)
    throw FileError(name, error.message());
  if (file.size == 0)
    throw FileError(name, "is empty");
  errno = 0;
  file.stream.open(name, std::ios::binary);
  if (!file.stream)
    throw FileError(name,
                    "cannot be opened: " + std::generic_category().message(errno));
  return file;
}

std::string
readText(const std::string& name, std::uint64_t max_size)
{
  InputFile file = openInput(name);
  if (file.size > max_size)
    throw FileError(name, "is too large (" + std::to_string(file.size) + " bytes)");
  std::string text(static_cast<std::size_t>(file.size), '\0');
  if (!file.stream.read(text.data(), static_cast<std::streamsize>(text.size())))
    throw FileError(name, "cannot be read");
  return text;
}

std::string
stateOf(const std::vector<std::string>& files)
{
  std::uint64_t hash = hash_of_nothing;
  for (const std::string& file : files) {
    std::error_code error;
    const auto time = fs::last_write_time(file, error).time_since_epoch().count();
    const auto size = error ? 0 : fs::file_size(file, error);
    if (error)
      return "";
    hash = hashOf(std::to_string(time) + ' ' + std::to_string(size) + '\n', hash);
  }
  return textOfHash(hash);
}

} // namespace bayesian_icp::io
