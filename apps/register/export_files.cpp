#include "register/export_files.h"

#include "io/errors.h"
#include "io/numbers.h"

#include <algorithm>
#include <ostream>
#include <stdexcept>

namespace bayesian_icp::app {

namespace {

constexpr std::size_t num_decimals_of_nanoseconds = 9;

/** A file of the pose for other software; a format may have several. */
struct ExportFile {
  const char* format;
  const char* name;
  std::string (*text)(const PoseEstimate&, const ExportOptions&);
};

constexpr ExportFile export_files[] = {
    {"ros", "pose_ros.yaml", rosYaml},
    {"g2o", "pose.g2o", g2oEdge},
    {"gtsam", "pose_gtsam.txt", gtsamText},
    {"tum", "pose_tum.txt", tumLine},
    {"tum", "pose_tum_covariance.txt", tumCovarianceLine},
    {"csv", "pose.csv", csvText}};

std::vector<ExportFile>
filesOf(const std::string& format)
{
  std::vector<ExportFile> files;
  for (const ExportFile& file : export_files)
    if (file.format == format)
      files.push_back(file);
  return files;
}

} // namespace

std::vector<std::string>
readExportFormats(const std::string& list)
{
  std::vector<std::string> formats;
  for (const auto item : io::splitAt(',', list)) {
    const std::string format(item);
    if (filesOf(format).empty())
      throw io::UsageError("--export: " + io::inQuotes(format) + " is not " +
                           export_format_names);
    if (std::find(formats.begin(), formats.end(), format) == formats.end())
      formats.push_back(format);
  }
  return formats;
}

std::int64_t
readTimestamp(const std::string& seconds)
{
  const auto pieces = io::splitAt('.', seconds);
  std::string decimals(pieces.size() == 2 ? pieces[1] : std::string_view());
  bool is_good = pieces.size() <= 2 && !pieces[0].empty() &&
                 pieces[0].size() <= num_decimals_of_nanoseconds + 1 &&
                 decimals.size() <= num_decimals_of_nanoseconds;
  decimals.resize(num_decimals_of_nanoseconds, '0');
  const std::string digits = std::string(pieces[0]) + decimals;
  std::int64_t nanoseconds = 0;
  is_good = is_good && digits.find_first_not_of("0123456789") == std::string::npos &&
            io::readNumber(digits, nanoseconds);
  ExportOptions options;
  options.timestamp_ns = nanoseconds;
  if (!is_good || !options.validate().empty())
    throw io::UsageError(
        "--timestamp: " + io::inQuotes(seconds) +
        " is not a number of seconds from 0 to below 2^31 with at most "
        "nine decimals");
  return nanoseconds;
}

std::string
exportText(const std::string& format,
           const PoseEstimate& estimate,
           const ExportOptions& options)
{
  return filesOf(format).front().text(estimate, options);
}

void
leaveOutExports(io::OutputFolder& folder)
{
  for (const ExportFile& file : export_files)
    folder.leaveOut(file.name);
}

std::vector<std::string>
addExports(const ExportRequest& request,
           const PoseEstimate& estimate,
           io::OutputFolder& folder)
{
  leaveOutExports(folder);
  std::vector<std::string> refusals;
  for (const std::string& format : request.formats)
    try {
      for (const ExportFile& file : filesOf(format))
        folder.add(file.name, file.text(estimate, request.options));
    }
    catch (const std::invalid_argument& error) {
      refusals.push_back("--export " + format + ": not written: " + error.what());
    }
  return refusals;
}

} // namespace bayesian_icp::app
