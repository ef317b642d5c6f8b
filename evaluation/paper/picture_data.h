/** \file
 * \brief CSV files of what the report's pictures of distributions show.
 */
#pragma once

#include "paper/paper_baseline.h"

#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Write baseline.csv: number of points and runs, share of the main basin and
 * spread of each pair's baseline.
 * \throws io::FileError */
void
writeBaselines(const std::string& folder, const std::vector<ComparedPair>& pairs);

/** \brief Write draws_PAIR.csv, the draws of the baseline and of a run of each method
 * that is shown (Bayesian ICP, calibrated, exact, Online-ICP; those without draws are
 * left out) with angles unwrapped about the baseline's mean; and points_PAIR.csv, at
 * most 500 points each of the target and of the source as it came, moved by the mean of
 * each of the first two methods, and where it belongs.
 * \throws io::FileError */
void
writePictureData(const ComparedPair& compared, const PaperStudyOptions& options);

} // namespace bayesian_icp::evaluate
