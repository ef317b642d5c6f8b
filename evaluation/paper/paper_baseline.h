/** \file
 * \brief The paper's baseline distribution: results of Monte Carlo ICP.
 */
#pragma once

#include "baselines/monte_carlo_icp.h"
#include "paper/paper_experiment.h"
#include "paper/paper_methods.h"

#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Where standard ICP ends from random starts about a pair's initial guess. */
struct PaperBaseline {
  /** Poses of all runs, canonical, one per row [m, rad]. */
  PoseMatrix ends;
  /** Those in the main basin: whose mean squared distance is at most twice the least.
   * The others are in far local minima. */
  PoseMatrix main_ends;
  /** Mean of each coordinate of all, circular of angles, which are unwrapped about it.
   */
  Vector6d mean = Vector6d::Zero();

  double
  mainShare() const
  {
    return static_cast<double>(main_ends.rows()) / static_cast<double>(ends.rows());
  }
};

/** \brief What the runs say. Runs that had too few pairs are left out.
 * \throws io::FileError if fewer than two are left */
PaperBaseline
baselineOf(const std::string& pair_name, const std::vector<MonteCarloIcpRun>& runs);

/** \brief A pair with its baseline. */
struct ComparedPair {
  /** \brief Take the baseline's runs that are in the output folder, and make the
   * others.
   * \param[in] scan_pair must outlive this object
   * \throws io::FileError */
  ComparedPair(const PaperStudy& study, const ScanPair& scan_pair);

  PaperProblem problem;
  PaperBaseline baseline;
  /** A hash of all that the baseline depends on, as 16 hexadecimal digits. */
  std::string key;
};

} // namespace bayesian_icp::evaluate
