/** \file
 * \brief Medians and worst cases of a study, as a text table.
 */
#pragma once

#include "samplers/score.h"

#include <iosfwd>

namespace bayesian_icp::evaluate {

/** \brief One line for each scene, cell and sampler. Step sizes of a sampler that were
 * only tried with the first seed are left out where another one has more runs. */
void
printTable(const std::vector<ScoredRun>& runs, std::ostream& stream);

} // namespace bayesian_icp::evaluate
