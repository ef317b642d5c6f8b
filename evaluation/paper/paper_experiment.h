/** \file
 * \brief What an experiment of the paper is: a sub-command by itself, and a section of
 * the report of `paper`.
 */
#pragma once

#include "paper/paper_options.h"
#include "paper/report_document.h"

#include <functional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief On what an experiment is made. */
struct PaperStudy {
  PaperOptions options;
  /** Those that could be read, thinned; at least one. */
  std::vector<ScanPair> pairs;
  /** Pairs that were asked for and could not be read. */
  int num_skipped = 0;
  /** Gets lines of progress. */
  std::function<void(const std::string&)> report;

  /** \brief The name of a file in the output folder, which exists. */
  std::string
  path(const std::string& file) const
  {
    return options.output_folder + "/" + file;
  }
};

/** \brief Runs what is not yet in the experiment's files in the output folder, writes
 * plots there, and says what came of all of it.
 * \throws io::FileError */
using Experiment = std::function<ReportSection(const PaperStudy&)>;

/** \brief A sub-command that makes experiments. */
struct ExperimentCommand {
  /** What --help says that it does. */
  std::string summary;
  std::function<void(const PaperStudy&)> run;
};

/** \brief Read options and pairs, make the output folder, and run the command;
 * progress goes to the standard error.
 * \return the exit code: 0, or 3 if a pair had to be skipped
 * \throws io::UsageError, io::FileError, boost::program_options::error */
int
runExperiments(const ExperimentCommand& command, int argc, const char* const* argv);

/** \brief Run an experiment as a sub-command; its section goes to the standard output
 * as Markdown. Otherwise as runExperiments().
 * \param[in] summary what --help says that it does */
int
runExperimentCommand(const Experiment& experiment,
                     const std::string& summary,
                     int argc,
                     const char* const* argv);

/** \brief Table I with everything around it. */
ReportSection
distributionExperiment(const PaperStudy& study);

/** \brief KL against the number of draws. */
ReportSection
samplesExperiment(const PaperStudy& study);

/** \brief KL against the length of burn-in. */
ReportSection
burnInExperiment(const PaperStudy& study);

/** \brief Seconds per 1000 draws for 1, 2, 4 threads. */
ReportSection
runtimeExperiment(const PaperStudy& study);

/** \brief Errors of posterior means, SGD-ICP and ICP from random starts. */
ReportSection
accuracyExperiment(const PaperStudy& study);

} // namespace bayesian_icp::evaluate
