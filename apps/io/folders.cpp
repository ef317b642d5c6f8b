#include "io/folders.h"

#include "io/errors.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace bayesian_icp::io {

namespace fs = std::filesystem;

std::string
folderOf(const std::string& file)
{
  const fs::path path(file);
  return path.has_parent_path() ? path.parent_path().string() : ".";
}

void
makeFolder(const std::string& folder)
{
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw FileError(folder, "cannot be made: " + error.message());
}

std::vector<std::string>
scansOf(const std::vector<std::string>& arguments)
{
  std::error_code error;
  if (arguments.size() != 1 || !fs::is_directory(arguments[0], error)) {
    if (arguments.size() < 2)
      throw UsageError("a folder or at least two scans are needed");
    return arguments;
  }
  std::vector<std::string> scans;
  for (const auto& entry : fs::directory_iterator(arguments[0], error))
    if (entry.path().extension() == ".pcd")
      scans.push_back(entry.path().string());
  if (error)
    throw FileError(arguments[0], error.message());
  std::sort(scans.begin(), scans.end());
  if (scans.size() < 2)
    throw FileError(arguments[0], "has fewer than two .pcd files");
  return scans;
}

} // namespace bayesian_icp::io
