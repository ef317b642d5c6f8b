#include "register/export_files.h"

#include "io/errors.h"
#include "io/numbers.h"
#include "register/choices.h"

#include <algorithm>
#include <ostream>
#include <stdexcept>

namespace bayesian_icp::app {

namespace {

constexpr std::size_t num_decimals_of_nanoseconds = 9;

const char*
fileNameOf(ExportFormat format)
{
  switch (format) {
  case ExportFormat::Ros:
    return "pose_ros.yaml";
  case ExportFormat::G2o:
    return "pose.g2o";
  case ExportFormat::Gtsam:
    return "pose_gtsam.txt";
  case ExportFormat::Tum:
    return "pose_tum.txt";
  case ExportFormat::Csv:
    return "pose.csv";
  }
  return "";
}

void
addText(const std::string& name, const std::string& text, io::OutputFolder& folder)
{
  folder.add(name, [&text](std::ostream& stream) { stream << text; });
}

} // namespace

const char*
toString(ExportFormat format)
{
  switch (format) {
  case ExportFormat::Ros:
    return "ros";
  case ExportFormat::G2o:
    return "g2o";
  case ExportFormat::Gtsam:
    return "gtsam";
  case ExportFormat::Tum:
    return "tum";
  case ExportFormat::Csv:
    return "csv";
  }
  return "";
}

std::vector<ExportFormat>
readExportFormats(const std::string& list)
{
  std::vector<ExportFormat> formats;
  for (const auto name : io::splitAt(',', list)) {
    ExportFormat format{};
    if (!readChoice(std::string(name), format))
      throw io::UsageError("--export: " + io::inQuotes(name) + " is not " +
                           namesOfChoices(format));
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
exportText(ExportFormat format,
           const PoseEstimate& estimate,
           const ExportOptions& options)
{
  switch (format) {
  case ExportFormat::Ros:
    return rosYaml(estimate, options);
  case ExportFormat::G2o:
    return g2oEdge(estimate, options);
  case ExportFormat::Gtsam:
    return gtsamText(estimate, options);
  case ExportFormat::Tum:
    return tumLine(estimate, options);
  case ExportFormat::Csv:
    return csvText(estimate, options);
  }
  return "";
}

std::vector<std::string>
addExports(const ExportRequest& request,
           const PoseEstimate& estimate,
           io::OutputFolder& folder)
{
  std::vector<std::string> refusals;
  for (const ExportFormat format : request.formats) {
    std::string text;
    try {
      text = exportText(format, estimate, request.options);
    }
    catch (const std::invalid_argument& error) {
      refusals.push_back(std::string("--export ") + toString(format) +
                         ": not written: " + error.what());
      continue;
    }
    addText(fileNameOf(format), text, folder);
    if (format == ExportFormat::Tum)
      addText("pose_tum_covariance.txt",
              tumCovarianceLine(estimate, request.options),
              folder);
  }
  return refusals;
}

} // namespace bayesian_icp::app
