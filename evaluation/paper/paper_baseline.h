/** \file
 * \brief The paper's baseline distribution: results of Monte Carlo ICP, ICP from random
 * starts, kept on disk run by run; and CSV files of what pictures of distributions
 * show.
 */
#pragma once

#include "paper/monte_carlo_icp.h"
#include "paper/paper_experiment.h"
#include "paper/paper_methods.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief What a run depends on besides its index, in one number: points, starts, seed,
 * criteria of ICP. How many runs, and by how many threads, is left out. */
std::uint64_t
monteCarloKey(const Eigen::Matrix3Xd& source,
              const Eigen::Matrix3Xd& target,
              const MonteCarloIcpOptions& options);

/** \brief FOLDER/monte_carlo_PAIR_KEY.csv, where the runs of a pair are kept: other
 * inputs have another file. */
std::string
monteCarloFile(const std::string& folder, const std::string& pair, std::uint64_t key);

/** \brief The runs first_run ... first_run + num_runs - 1 of the options, in this
 * order: those of the file, and for the others they are made and written there, a
 * hundred at a time, so that an interrupted study goes on where it stopped. Bit for bit
 * the result of monteCarloIcp().
 * \param[in] file made, with its folder, if it is missing
 * \param[in] report gets a line of progress now and then
 * \throws io::FileError if the file cannot be written, or has a bad row */
std::vector<MonteCarloIcpRun>
keptMonteCarloRuns(const Eigen::Matrix3Xd& source,
                   const Eigen::Matrix3Xd& target,
                   const MonteCarloIcpOptions& options,
                   const std::string& file,
                   const std::function<void(const std::string&)>& report);

/** \brief Ends of the runs that had enough pairs, one per row [m, rad], canonical: the
 * draws of the baseline. */
PoseMatrix
endsOf(const std::vector<MonteCarloIcpRun>& runs);

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
   * \param[in] pair must outlive this object
   * \throws io::FileError */
  ComparedPair(const PaperStudy& study, const ScanPair& pair);

  PaperProblem problem;
  PaperBaseline baseline;
  /** A hash of all that the baseline depends on, as 16 hexadecimal digits. */
  std::string key;
};

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
