/** \file
 * \brief The reports of the studies, which Python makes from their CSV files.
 */
#pragma once

#include <string>

namespace bayesian_icp::evaluate {

/** \brief Have report.md, report.html and figures made of the CSV files in a folder,
 * and print the name of the page. Without Python, pandas or matplotlib the standard
 * error says what is missing. Python is what the environment variable
 * PCL_BAYESIAN_ICP_PYTHON names, or python3, or Debian's. \return the exit code: 0, or
 * 3 without a report \throws io::FileError if the folder has no study, or cannot be
 * written to */
int
makeReport(const std::string& folder);

/** \brief Run the sub-command `report`.
 * \return the exit code, see makeReport()
 * \throws io::UsageError, io::FileError */
int
runReportCommand(int argc, const char* const* argv);

} // namespace bayesian_icp::evaluate
