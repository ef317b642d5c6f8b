#include "register/export_files.h"

#include <stdexcept>

namespace bayesian_icp::app {

namespace {

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

bool
isExportFormat(const std::string& name)
{
  return !filesOf(name).empty();
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
