/** \file
 * \brief What an experiment of the paper is: a sub-command by itself, and a part of
 * `paper`.
 */
#pragma once

#include "paper/paper_options.h"

#include <functional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief On what an experiment is made. */
struct PaperStudy {
  /** The sub-command. */
  std::string command;
  PaperStudyOptions options;
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

/** \brief Runs what is not yet in the experiment's files in the output folder, and
 * prints medians of all of it.
 * \throws io::FileError */
using Experiment = std::function<void(const PaperStudy&)>;

/** \brief Table I with everything around it. */
void
distributionExperiment(const PaperStudy& study);

/** \brief KL against the number of draws. */
void
samplesExperiment(const PaperStudy& study);

/** \brief KL against the length of burn-in. */
void
burnInExperiment(const PaperStudy& study);

/** \brief Seconds per 1000 draws for 1, 2, 4 threads. */
void
runtimeExperiment(const PaperStudy& study);

/** \brief Errors of posterior means, SGD-ICP and ICP from random starts. */
void
accuracyExperiment(const PaperStudy& study);

} // namespace bayesian_icp::evaluate
