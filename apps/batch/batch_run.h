/** \file
 * \brief Registers pairs on all processors, whatever happens to some of them.
 */
#pragma once

#include "batch/manifest.h"
#include "register/run.h"

#include <functional>
#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief The status of a pair that could not be registered. */
constexpr const char* error_status = "error";

/** \brief A pair that has ended. */
struct BatchResult {
  const BatchPair& pair;
  /** Null if it could not be registered. */
  const Run* run;
  /** Short name of the Status, or error_status; and in words. */
  std::string status;
  std::string message;
  /** From reading the clouds to the posterior. */
  double seconds;
  /** BatchPair::filesState() before they were read. */
  std::string files_state;
};

/** \brief Register the pairs, reading the clouds of each when its turn comes.
 *
 * A pair that fails, by an exception too, has a result that says so. After an interrupt
 * no pair is begun, and those under way are given up, without a result.
 * \param[in] num_threads 0 for as many as OpenMP offers. With more pairs than threads
 *            each pair has one, otherwise the pairs share them evenly. The results do
 *            not depend on it.
 * \param[in] output_folder for a folder a pair with posterior.json and samples.csv;
 *            empty for none
 * \param[in] take gets each result as it comes, by one thread at a time
 * \throws io::FileError if files of a pair cannot be written, and what \p take throws;
 *         nothing more is begun then */
void
runBatch(const std::vector<BatchPair>& pairs,
         int num_threads,
         const std::string& output_folder,
         const std::function<void(const BatchResult&)>& take);

} // namespace bayesian_icp::app
