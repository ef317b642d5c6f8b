#include "io/output_folder.h"

#include "io/errors.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace bayesian_icp::io {

namespace fs = std::filesystem;

namespace {

std::string
reasonOf(int error)
{
  return "cannot be written: " +
         (error != 0 ? std::generic_category().message(error) : "unknown error");
}

/** A new, empty file beside \p name, with the rights of any new file. */
std::string
makeTemporaryFile(const std::string& name)
{
  std::string temporary_name = name + ".XXXXXX";
  const int descriptor = mkstemp(temporary_name.data());
  if (descriptor < 0)
    throw FileError(name, reasonOf(errno));
  const mode_t mask = umask(0);
  umask(mask);
  fchmod(descriptor, 0666 & ~mask);
  close(descriptor);
  return temporary_name;
}

} // namespace

OutputFolder::OutputFolder(const std::string& folder) : folder_(folder)
{
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw FileError(folder, "cannot be made: " + error.message());
  if (!fs::is_directory(folder, error))
    throw FileError(folder, "is not a folder");
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw FileError(folder, reasonOf(errno));
}

OutputFolder::~OutputFolder()
{
  std::error_code ignored;
  for (const File& file : files_)
    fs::remove(file.temporary_name, ignored);
}

void
OutputFolder::addByName(const std::string& name,
                        const std::function<void(const std::string& path)>& write)
{
  const std::string path = (fs::path(folder_) / name).string();
  if (fs::is_directory(path))
    throw FileError(path, "is a directory");
  files_.push_back({makeTemporaryFile(path), path});
  try {
    write(files_.back().temporary_name);
  }
  catch (const FileError&) {
    throw;
  }
  catch (const std::exception& error) {
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
      throw FileError((fs::path(folder_) / name).string(), reasonOf(errno));
  });
}

void
OutputFolder::commit()
{
  while (!files_.empty()) {
    std::error_code error;
    fs::rename(files_.back().temporary_name, files_.back().name, error);
    if (error)
      throw FileError(files_.back().name, reasonOf(error.value()));
    files_.pop_back();
  }
}

} // namespace bayesian_icp::io
