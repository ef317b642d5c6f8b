/** \file
 * \brief The pose for other software: what --export asks for.
 */
#pragma once

#include "io/output_folder.h"

#include <bayesian_icp/exports.h>

#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief What --export and the options that go with it say. */
struct ExportRequest {
  std::vector<std::string> formats;
  /** Whether the prior is removed. */
  bool is_without_prior = false;
  ExportOptions options;
};

constexpr const char* export_format_names = "ros, g2o, gtsam, tum or csv";

/** \brief Whether \p name is one of these. */
bool
isExportFormat(const std::string& name);

/** \brief The text of one format, of TUM without the covariance.
 * \throws std::invalid_argument if the posterior cannot be exported to it */
std::string
exportText(const std::string& format,
           const PoseEstimate& estimate,
           const ExportOptions& options);

/** \brief Leave out all files that addExports() can add. */
void
leaveOutExports(io::OutputFolder& folder);

/** \brief Add pose_ros.yaml, pose.g2o, pose_gtsam.txt, pose_tum.txt with
 * pose_tum_covariance.txt, and pose.csv, as asked for, and leave out the others.
 * \return the formats to which the posterior cannot be exported, with the reason, one
 *         message each
 * \throws io::FileError if a file cannot be written */
std::vector<std::string>
addExports(const ExportRequest& request,
           const PoseEstimate& estimate,
           io::OutputFolder& folder);

} // namespace bayesian_icp::app
