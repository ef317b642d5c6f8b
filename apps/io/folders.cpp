#include "io/folders.h"

#include "io/errors.h"

#include <boost/algorithm/string/predicate.hpp>

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

/** The whole number in a name in which it differs from others, and what is around it.
 */
struct NumberedName {
  std::string before, number, after;

  /** \param[in] first place of the first difference */
  NumberedName(const std::string& name, std::size_t first)
  {
    constexpr const char* digits = "0123456789";
    const std::size_t last = name.substr(0, first).find_last_not_of(digits);
    const std::size_t begin = last == std::string::npos ? 0 : last + 1;
    const std::size_t end =
        std::min(name.find_first_not_of(digits, begin), name.size());
    before = name.substr(0, begin);
    number = name.substr(begin, end - begin);
    after = name.substr(end);
  }
};

/** What is in a text beside numbers, which may have decimals. */
std::string
withoutNumbers(std::string text)
{
  const auto isOfNumber = [](char c) { return (c >= '0' && c <= '9') || c == '.'; };
  text.erase(std::remove_if(text.begin(), text.end(), isOfNumber), text.end());
  return text;
}

/** Of the same name but for numbers, of which the first that differs is smaller.
 * Decimals of a number are none.
 */
bool
isNumberedBefore(const std::string& file, const std::string& other_file)
{
  const std::string a = fs::path(file).stem().string();
  const std::string b = fs::path(other_file).stem().string();
  const auto first = static_cast<std::size_t>(
      std::mismatch(a.begin(), a.end(), b.begin(), b.end()).first - a.begin());
  const NumberedName name(a, first), other(b, first);
  const bool has_decimals = !name.before.empty() && name.before.back() == '.';
  return !has_decimals && withoutNumbers(name.after) == withoutNumbers(other.after) &&
         !name.number.empty() && name.number.size() < other.number.size();
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
