#include "io/line_file.h"

#include "io/errors.h"
#include "io/folders.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <system_error>

namespace bayesian_icp::io {

namespace {

std::string
reasonOf(int error)
{
  return "cannot be written: " + std::generic_category().message(error);
}

/** A descriptor that is closed if something goes wrong on the way. */
struct Descriptor {
  int value = -1;

  ~Descriptor()
  {
    if (value >= 0)
      close(value);
  }

  int
  release()
  {
    const int released = value;
    value = -1;
    return released;
  }
};

int
openLocked(const std::string& name)
{
  makeFolder(folderOf(name));
  Descriptor file;
  file.value = open(name.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file.value < 0)
    throw FileError(name, reasonOf(errno));
  struct stat status = {};
  if (fstat(file.value, &status) != 0 || !S_ISREG(status.st_mode))
    throw FileError(name, "is not a regular file");
  // Other errors are of file systems without locks.
  if (flock(file.value, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    throw FileError(name, "is in use by another process");
  return file.release();
}

} // namespace

LineFile::LineFile(const std::string& name,
                   const std::function<void(const std::string& line)>& read_line)
: name_(name)
{
  Descriptor file{openLocked(name)};
  descriptor_ = file.value;
  std::ifstream stream(name, std::ios::binary);
  if (!stream)
    throw FileError(name, "cannot be read");
  long complete_size = 0;
  std::string line;
  while (std::getline(stream, line) && !stream.eof()) {
    complete_size += static_cast<long>(line.size()) + 1;
    read_line(line);
  }
  is_new_ = complete_size == 0;
  if (is_new_ && !line.empty())
    throw FileError(name, "has no complete line: it is not a file of results");
  cutTo(complete_size);
  file.release();
}

LineFile::~LineFile() { close(descriptor_); }

void
LineFile::cutTo(long size) const
{
  struct stat status = {};
  const bool is_longer = fstat(descriptor_, &status) != 0 || status.st_size > size;
  if (is_longer && ftruncate(descriptor_, size) != 0)
    throw FileError(name_, reasonOf(errno));
}

void
LineFile::add(const std::string& line) const
{
  const off_t size = lseek(descriptor_, 0, SEEK_END);
  const std::string text = line + '\n';
  std::size_t num_written = 0;
  while (num_written < text.size()) {
    const ssize_t count =
        write(descriptor_, text.data() + num_written, text.size() - num_written);
    if (count < 0 && errno == EINTR)
      continue;
    if (count <= 0) {
      const int error = count < 0 ? errno : ENOSPC;
      cutTo(size);
      throw FileError(name_, reasonOf(error));
    }
    num_written += static_cast<std::size_t>(count);
  }
}

} // namespace bayesian_icp::io
