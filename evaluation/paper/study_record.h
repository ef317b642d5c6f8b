/** \file
 * \brief study.json: which rows of the CSV files are the study's, how they were made,
 * and how to make them again.
 */
#pragma once

#include "paper/paper_experiment.h"

#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief A pair, and the column `key` of its rows. */
struct PairKey {
  std::string pair;
  std::string key;
};

/** \brief Note what the last run of an experiment asked for: command, seeds, pairs; and
 * the versions of what took part. What is there of other experiments stays.
 * \param[in] name of its CSV file, without .csv
 * \param[in] num_starts rows are those of the first seed and of this number of starts;
 *            0: of as many seeds as there are repeats
 * \throws io::FileError */
void
recordExperiment(const PaperStudy& study,
                 const std::string& name,
                 const std::vector<PairKey>& pairs,
                 int num_starts = 0);

} // namespace bayesian_icp::evaluate
