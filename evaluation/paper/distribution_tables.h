/** \file
 * \brief Table I and its companions, made of runs.
 */
#pragma once

#include "paper/distribution_study.h"
#include "paper/paper_table.h"
#include "paper/report_document.h"

#include <functional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

using Distributions = std::vector<PairDistribution>;

/** \brief A number of a run. */
using RunNumber = std::function<double(const DistributionRun&)>;

/** \brief KL of coordinate \p k. */
RunNumber
coordinateKl(int k);

/** \brief Spread of a number over the runs of a method. */
Spread
spreadIn(const PairDistribution& pair,
         const std::string& method,
         const RunNumber& number);

/** \brief Our Table I beside the paper's, a table a coordinate, rows in the order of
 * the pairs that the paper has; before them, in how many cells the orders agree. Empty
 * if the paper has none of the pairs. */
std::vector<ReportTable>
comparisonTables(const Distributions& distributions);

/** \brief A table a pair: KL of every method, per coordinate, in 6-D, and to the main
 * basin. */
std::vector<ReportTable>
divergenceTables(const Distributions& distributions);

/** \brief A table a pair: Wasserstein-1 distances, energy scores, errors, NEES and
 * coverage of every method. */
std::vector<ReportTable>
scoreTables(const Distributions& distributions);

/** \brief Statuses and diagnostics of the methods that sample by chains: whether they
 * sampled anything. */
ReportTable
mixingTable(const Distributions& distributions);

/** \brief Number of runs, share of the main basin and spread of each pair's baseline.
 */
ReportTable
baselineTable(const Distributions& distributions);

} // namespace bayesian_icp::evaluate
