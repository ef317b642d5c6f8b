/** \file
 * \brief A coverage study as a text table.
 */
#pragma once

#include "coverage/coverage_file.h"

#include <iosfwd>

namespace bayesian_icp::evaluate {

/** \brief A block of one line a method for each scene and condition, for each scene and
 * each condition that has several, and for all; in the order in which \p runs name them
 * first. Runs of recordings have columns of their own. */
void
printCoverageTable(const std::vector<CoverageRun>& runs, std::ostream& stream);

} // namespace bayesian_icp::evaluate
