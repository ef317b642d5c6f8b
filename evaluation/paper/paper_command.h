/** \file
 * \brief The sub-commands of the paper's evaluation: an experiment each, and `paper`,
 * which makes all of them.
 */
#pragma once

#include "paper/paper_experiment.h"

#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

struct NamedExperiment {
  /** Of the sub-command. */
  std::string name;
  /** What it does: one line, and more for --help. */
  std::string summary;
  std::string details;
  Experiment run;
};

/** \brief In the order of the report. */
const std::vector<NamedExperiment>&
paperExperiments();

/** \brief Run the sub-command of an experiment.
 * \return the exit code: 0, or 3 if a pair had to be skipped or there is no report
 * \throws io::UsageError, io::FileError */
int
runExperimentCommand(const NamedExperiment& experiment,
                     int argc,
                     const char* const* argv);

/** \brief Run the sub-command `paper`: all experiments into one folder.
 * \return and \throws as runExperimentCommand() */
int
runPaperCommand(int argc, const char* const* argv);

} // namespace bayesian_icp::evaluate
