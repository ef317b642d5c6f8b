#include "io/line_file.h"

#include "io/errors.h"
#include "io/folders.h"
#include "io/output_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <utility>

namespace bayesian_icp::io {

namespace {

int
openToAppend(const std::string& name)
{
  makeFolder(folderOf(name));
  const int descriptor =
      open(name.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor < 0)
    throw FileError(name, reasonNotWritten(errno));
  return descriptor;
}

} // namespace

LineFile::LineFile(const std::string& name, int descriptor)
: name_(name)
, descriptor_(descriptor)
{}

// Delegates, so that the destructor closes the file if something goes wrong here.
LineFile::LineFile(const std::string& name,
                   const std::function<bool(const std::string& line)>& read_line)
: LineFile(name, openToAppend(name))
{
  struct stat status = {};
  if (fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode))
    throw FileError(name, "is not a regular file");
  // Other errors are of file systems without locks.
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    throw FileError(name, "is in use by another process");
  std::ifstream stream(name, std::ios::binary);
  if (!stream)
    throw FileError(name, "cannot be read");
  long complete_size = 0;
  std::string line, kept;
  while (std::getline(stream, line) && !stream.eof()) {
    complete_size += static_cast<long>(line.size()) + 1;
    if (read_line(line))
      kept += line + '\n';
  }
  is_new_ = complete_size == 0;
  if (is_new_ && !line.empty())
    throw FileError(name, "has no complete line: it is not a file of results");
  cutTo(complete_size);
  if (static_cast<long>(kept.size()) == complete_size)
    return;
  OutputFolder folder(folderOf(name));
  folder.add(std::filesystem::path(name).filename().string(), kept);
  folder.commit();
  LineFile replaced(name, [](const std::string&) { return true; });
  std::swap(descriptor_, replaced.descriptor_);
}

LineFile::~LineFile() { close(descriptor_); }

void
LineFile::cutTo(long size) const
{
  struct stat status = {};
  const bool is_longer = fstat(descriptor_, &status) != 0 || status.st_size > size;
  if (is_longer && ftruncate(descriptor_, size) != 0)
    throw FileError(name_, reasonNotWritten(errno));
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
      throw FileError(name_, reasonNotWritten(error));
    }
    num_written += static_cast<std::size_t>(count);
  }
}

} // namespace bayesian_icp::io
