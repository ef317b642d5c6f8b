#include "io/output_folder.h"

#include "io/errors.h"
#include "io/folders.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <new>
#include <random>
#include <system_error>

namespace bayesian_icp::io {

namespace fs = std::filesystem;

namespace {

/** A new, empty file beside \p name, with the rights of any new file. */
std::string
makeTemporaryFile(const std::string& name)
{
  constexpr int max_attempts = 100;
  std::random_device random;
  for (int attempt = 0; attempt < max_attempts; ++attempt) {
    const std::string temporary_name = name + '.' + std::to_string(random());
    const int descriptor =
        open(temporary_name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) {
      close(descriptor);
      return temporary_name;
    }
    if (errno != EEXIST)
      break;
  }
  throw FileError(name, reasonNotWritten(errno));
}

/** Keeps other processes out of commit() to the same folder, as far as its file system
 * has locks. */
class FolderLock {
public:
  explicit FolderLock(const std::string& folder)
  : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC))
  {
    while (descriptor_ >= 0 && flock(descriptor_, LOCK_EX) != 0 && errno == EINTR)
      ;
  }
  ~FolderLock()
  {
    if (descriptor_ >= 0)
      close(descriptor_);
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock&
  operator=(const FolderLock&) = delete;

private:
  int descriptor_;
};

} // namespace

OutputFolder::OutputFolder(const std::string& folder) : folder_(folder)
{
  std::error_code error;
  for (fs::path path = folder; !path.empty() && !fs::exists(path, error);
       path = path.parent_path())
    new_folders_.push_back(path.string());
  makeFolder(folder);
  if (!fs::is_directory(folder, error))
    throw FileError(folder, "is not a folder");
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw FileError(folder, reasonNotWritten(errno));
}

OutputFolder::~OutputFolder()
{
  std::error_code ignored;
  for (const File& file : files_)
    fs::remove(file.temporary_name, ignored);
  for (const std::string& folder : new_folders_)
    fs::remove(folder, ignored); // fails if something is in it
}

std::string
OutputFolder::fileOf(const std::string& name) const
{
  const fs::path path = fs::path(folder_) / name;
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw FileError(path.string(), "is not a regular file");
  return fs::is_symlink(path, ignored) && fs::exists(status)
             ? fs::canonical(path).string()
             : path.string();
}

void
OutputFolder::addByName(const std::string& name,
                        const std::function<void(const std::string& path)>& write)
{
  const std::string path = fileOf(name);
  makeFolder(folder_); // another process that made it may have removed it
  files_.push_back({makeTemporaryFile(path), path});
  left_out_.erase(name);
  errno = 0;
  try {
    write(files_.back().temporary_name);
  }
  catch (const FileError&) {
    throw;
  }
  catch (const std::bad_alloc&) {
    throw;
  }
  catch (const std::exception& error) {
    if (errno == ENOMEM)
      throw std::bad_alloc();
    throw FileError(path, std::string("cannot be written: ") + error.what());
  }
}

void
OutputFolder::add(const std::string& name,
                  const std::function<void(std::ostream&)>& write)
{
  addByName(name, [&](const std::string& path) {
    errno = 0;
    std::ofstream stream(path, std::ios::binary);
    write(stream);
    stream.close();
    if (!stream)
      throw FileError((fs::path(folder_) / name).string(), reasonNotWritten(errno));
  });
}

void
OutputFolder::add(const std::string& name, const std::string& text)
{
  add(name, [&text](std::ostream& stream) { stream << text; });
}

void
OutputFolder::leaveOut(const std::string& name)
{
  left_out_.insert(name);
}

void
OutputFolder::commit()
{
  const FolderLock lock(folder_);
  while (!files_.empty()) {
    std::error_code error;
    fs::rename(files_.back().temporary_name, files_.back().name, error);
    if (error)
      throw FileError(files_.back().name, reasonNotWritten(error.value()));
    files_.pop_back();
  }
  for (const std::string& left_out : left_out_) {
    const std::string name = (fs::path(folder_) / left_out).string();
    std::error_code error;
    if (!fs::remove(name, error) && error)
      throw FileError(name, "cannot be removed: " + error.message());
  }
}

} // namespace bayesian_icp::io
