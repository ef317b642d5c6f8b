/** \file
 * \brief CSV files of what the report's pictures of distributions show.
 */
#pragma once

#include "paper/distribution_study.h"

#include <string>
#include <utility>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Draws of methods, by the methods' names. */
using NamedDraws = std::vector<std::pair<std::string, PoseMatrix>>;

/** \brief A run of each method that is shown: Bayesian ICP, calibrated, exact,
 * Online-ICP, those without draws left out. */
NamedDraws
shownDraws(const PaperProblem& problem, const PaperStudyOptions& options);

/** \brief Write baseline.csv: number of points and runs, share of the main basin and
 * spread of each pair's baseline.
 * \throws io::FileError */
void
writeBaselines(const std::string& folder, const std::vector<PairDistribution>& pairs);

/** \brief Write draws_PAIR.csv, the draws of baseline and methods with angles unwrapped
 * about the baseline's mean; and points_PAIR.csv, at most 500 points each of the target
 * and of the source as it came, moved by the mean of each of the first two methods, and
 * where it belongs.
 * \throws io::FileError */
void
writePictureData(const std::string& folder,
                 const ScanPair& pair,
                 const PaperBaseline& baseline,
                 const NamedDraws& methods);

} // namespace bayesian_icp::evaluate
