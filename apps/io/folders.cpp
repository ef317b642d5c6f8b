#include "io/folders.h"

#include "io/errors.h"

#include <boost/algorithm/string/predicate.hpp>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

namespace bayesian_icp::io {

namespace fs = std::filesystem;

std::string
folderOf(const std::string& file)
{
  const fs::path path(file);
  return path.has_parent_path() ? path.parent_path().string() : ".";
}

bool
isSameFile(const std::string& a, const std::string& b)
{
  std::error_code ignored;
  return fs::equivalent(a, b, ignored);
}

void
makeFolder(const std::string& folder)
{
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw FileError(folder, "cannot be made: " + error.message());
}

namespace {

/** The name of a file without its extension and the whole number that it ends in. */
std::pair<std::string, std::string>
numberedName(const std::string& file)
{
  const std::string name = fs::path(file).stem().string();
  const std::size_t last = name.find_last_not_of("0123456789");
  const std::size_t first = last == std::string::npos ? 0 : last + 1;
  return {name.substr(0, first), name.substr(first)};
}

/** Of the same name but for the number, which is smaller. Decimals of a number are
 * none.
 */
bool
isNumberedBefore(const std::string& a, const std::string& b)
{
  const auto [name_a, number_a] = numberedName(a);
  const auto [name_b, number_b] = numberedName(b);
  const bool has_decimals = !name_a.empty() && name_a.back() == '.';
  return !has_decimals && name_a == name_b && number_a.size() < number_b.size();
}

} // namespace

std::vector<std::string>
scansOf(const std::vector<std::string>& arguments)
{
  std::error_code error;
  if (arguments.size() != 1 || !fs::is_directory(arguments[0], error)) {
    if (arguments.size() == 1 && !fs::exists(arguments[0], error))
      throw FileError(arguments[0], "no such folder");
    if (arguments.size() < 2)
      throw UsageError("a folder or at least two scans are needed");
    return arguments;
  }
  std::vector<std::string> scans;
  for (fs::directory_iterator entry(arguments[0], error), end; !error && entry != end;
       entry.increment(error))
    if (boost::iequals(entry->path().extension().string(), ".pcd"))
      scans.push_back(entry->path().string());
  if (error)
    throw FileError(arguments[0], error.message());
  std::sort(scans.begin(), scans.end());
  if (scans.size() < 2)
    throw FileError(arguments[0], "has fewer than two .pcd files");
  for (std::size_t k = 1; k < scans.size(); ++k)
    if (isNumberedBefore(scans[k], scans[k - 1]))
      throw FileError(scans[k],
                      "comes after " + fs::path(scans[k - 1]).filename().string() +
                          " by name, but before it by number: give all numbers as "
                          "many digits, or name the files in their order");
  return scans;
}

} // namespace bayesian_icp::io
