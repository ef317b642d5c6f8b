/** \file
 * \brief Pictures of a coverage study, drawn by gnuplot.
 */
#pragma once

#include "coverage/coverage_file.h"

#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Write, as SVG and PNG, into a folder: coverage (share of truths within the
 * region of each probability, a curve a method), pit (histograms of the six
 * coordinates, a row a method) and anees (mean NEES / 6 of each scene and condition).
 * \throws io::FileError */
void
plotCoverage(const std::vector<CoverageRun>& runs, const std::string& folder);

} // namespace bayesian_icp::evaluate
