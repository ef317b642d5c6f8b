/** \file
 * \brief What the runs of one method say together.
 */
#pragma once

#include "coverage/coverage_study.h"
#include "study/text_table.h"

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Probabilities whose regions are looked at. */
constexpr std::array<double, 4> coverage_levels = {0.50, 0.68, 0.90, 0.95};

/** \brief A share and its 95 % confidence interval (Wilson's); NaN of nothing. */
struct Share {
  double value;
  double low;
  double high;
};

/** \brief The share \p num_hits of \p num_trials, of which at most
 * \p most_independent are independent. */
Share
shareOf(std::size_t num_hits,
        std::size_t num_trials,
        std::size_t most_independent = std::numeric_limits<std::size_t>::max());

/** \brief Squared Mahalanobis distances of the truth (NEES) beyond which a Gaussian has
 * 1 % and 0.01 %. A run below the first that is not lost is good, one that is lost or
 * above the second is bad. */
constexpr double max_good_nees = 16.812;
constexpr double min_bad_nees = 27.856;

/** \brief Shares, means and medians are over the runs that have the number; NaN without
 * any. Seeds move a real pair and leave its points and their errors as they are, so the
 * intervals count each pair once. */
struct CoverageSummary {
  std::size_t num_runs = 0;
  std::size_t num_valid = 0;
  /** Of recordings. */
  std::size_t num_lost = 0;
  /** Good runs, and those of them that their method doubts; bad ones, and those that it
   * does not doubt. Poses alone are neither. */
  std::size_t num_good = 0;
  std::size_t num_alarms = 0;
  std::size_t num_bad = 0;
  std::size_t num_misses = 0;
  /** Mean of nees / 6 of the runs that are not lost; 1 if the posteriors are right. */
  double anees;
  /** Shares of runs with the truth within the region of each of coverage_levels. */
  std::array<Share, coverage_levels.size()> coverage;
  double mean_log_score;
  double mean_energy_score;
  /** Medians [m, rad]. */
  double translation_error;
  double rotation_error;
  /** Share of flagged runs, of all and of those outside the 95 % region. */
  Share flagged;
  Share flagged_outside;
  double median_seconds;
  /** Negative if not counted. */
  double median_queries;
};

CoverageSummary
summaryOf(const std::vector<CoverageRun>& runs);

/** \brief A block of one line a method for each scene and condition, for each scene and
 * each condition that has several, and for all; in the order in which \p runs name them
 * first. Runs of recordings have a table of their own, with other columns. */
std::vector<TextTable>
coverageTables(const std::vector<CoverageRun>& runs);

} // namespace bayesian_icp::evaluate
