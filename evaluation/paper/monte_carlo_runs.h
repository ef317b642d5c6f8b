/** \file
 * \brief The baseline of a pair, ICP from random starts, kept on disk run by run.
 */
#pragma once

#include "baselines/monte_carlo_icp.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief What a run depends on besides its index, in one number: points, starts, seed,
 * criteria of ICP. How many runs, and by how many threads, is left out. */
std::uint64_t
monteCarloKey(const Eigen::Matrix3Xd& source,
              const KdTree& target,
              const MonteCarloIcpOptions& options);

/** \brief Where the runs of one pair are kept. */
struct MonteCarloFile {
  /** Made if it is missing. */
  std::string folder;
  /** Of the pair; part of the file's name. */
  std::string pair;

  /** \brief FOLDER/monte_carlo_PAIR_KEY.csv: other inputs have another file. */
  std::string
  name(std::uint64_t key) const;
};

/** \brief The runs first_run ... first_run + num_runs - 1 of the options, in this
 * order: those of the file, and for the others they are made and written there, a
 * hundred at a time, so that an interrupted study goes on where it stopped. Bit for bit
 * the result of monteCarloIcp().
 * \param[in] report gets a line of progress now and then; may be empty
 * \throws io::FileError if the file cannot be written, or has a bad row */
std::vector<MonteCarloIcpRun>
keptMonteCarloRuns(const Eigen::Matrix3Xd& source,
                   const KdTree& target,
                   const MonteCarloIcpOptions& options,
                   const MonteCarloFile& file,
                   const std::function<void(const std::string&)>& report);

/** \brief Ends of the runs that had enough pairs, one per row [m, rad], canonical: the
 * draws of the baseline. */
PoseMatrix
endsOf(const std::vector<MonteCarloIcpRun>& runs);

} // namespace bayesian_icp::evaluate
