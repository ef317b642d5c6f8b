/** \file
 * \brief Ranks as a text table.
 */
#pragma once

#include "sbc/rank_study.h"

#include <iosfwd>

namespace bayesian_icp::evaluate {

/** \brief A line for each sampler: runs, chi-square statistic of each coordinate,
 * verdict.
 * \return whether every well-specified sampler has uniform ranks: all runs good and
 *         every statistic below max_rank_chi_square */
bool
printRankTable(const RankStudy& study, const RankFile& results, std::ostream& stream);

} // namespace bayesian_icp::evaluate
