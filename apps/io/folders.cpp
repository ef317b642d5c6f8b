#include "io/folders.h"

#include "io/errors.h"

#include <filesystem>
#include <system_error>

namespace bayesian_icp::io {

std::string
folderOf(const std::string& file)
{
  const std::filesystem::path path(file);
  return path.has_parent_path() ? path.parent_path().string() : ".";
}

void
makeFolder(const std::string& folder)
{
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw FileError(folder, "cannot be made: " + error.message());
}

} // namespace bayesian_icp::io
