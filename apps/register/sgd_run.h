/** \file
 * \brief SGD-ICP of two files: its result and its report.
 */
#pragma once

#include "io/cloud_file.h"
#include "register/command_line.h"

#include <string>

namespace bayesian_icp::app {

struct SgdRun {
  SgdSettings settings;
  io::CloudFile source;
  io::CloudFile target;
  StochasticGradientIcpResult result;
  /** Of the moved source to the target [m^2], without a gate. */
  double mean_squared_distance = 0.0;
  double reading_seconds = 0.0;
  double registration_seconds = 0.0;
};

/** \brief The result in words. */
std::string
endText(const SgdRun& run);

/** \brief The table: pose with units, steps, distance, time, matrix. */
std::string
sgdReportText(const SgdRun& run);

/** \brief The same and the options as JSON, units in the names of keys. */
std::string
sgdJson(const SgdRun& run);

/** \brief Register by SGD-ICP and report as asked.
 * \return the exit code: 0 if the descent came to rest, 1 if not, 130 if interrupted
 * \throws io::FileError for clouds and results */
int
runSgdIcp(const Request& request);

} // namespace bayesian_icp::app
