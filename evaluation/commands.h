/** \file
 * \brief The sub-commands of pcl_bayesian_icp_evaluate.
 */
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** All take the command line from the sub-command's name on, return the exit code (0
 * but for what is said below), and throw io::UsageError and io::FileError. */

/** \brief Posteriors of every method against the truth. */
int
runCoverageCommand(int argc, const char* const* argv);

/** \brief Are the covariances of a pose graph's edges right, judged without the truth?
 * \return 1 if the errors of the closures are larger than chance allows */
int
runCyclesCommand(int argc, const char* const* argv);

/** \brief Every sampler on every scene and cell, next to a gold standard.
 * \return 1 if a gold standard did not converge */
int
runSamplersCommand(int argc, const char* const* argv);

/** \brief Simulation-based calibration of the samplers.
 * \return 1 if the ranks of a well-specified model are not uniform */
int
runSbcCommand(int argc, const char* const* argv);

/** \brief Do covariances of registrations make trajectories better, and is their stated
 * accuracy true? */
int
runTrajectoriesCommand(int argc, const char* const* argv);

/** \brief Have report.md, report.html and figures made of the CSV files in a folder,
 * and print the name of the page. Python makes them: what the environment variable
 * PCL_BAYESIAN_ICP_PYTHON names, or python3, or Debian's. Without Python, pandas or
 * matplotlib the standard error says what is missing.
 * \return the exit code: 0, or 3 without a report
 * \throws io::FileError if the folder has no study, or cannot be written to */
int
makeReport(const std::string& folder);

/** \brief makeReport() as a sub-command. */
int
runReportCommand(int argc, const char* const* argv);

/** \brief A sub-command and what its line of the tool's help says. */
struct SubCommand {
  std::string name;
  std::string summary;
  /** One of the functions above, or as them. */
  std::function<int(int argc, const char* const* argv)> run;
};

/** \brief `paper`, all experiments of the paper into one folder, and each of them by
 * itself. They return 3 if a pair had to be skipped or there is no report. */
std::vector<SubCommand>
paperCommands();

} // namespace bayesian_icp::evaluate
