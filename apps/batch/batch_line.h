/** \file
 * \brief The line of JSON that a pair of a batch ends in.
 */
#pragma once

#include "batch/batch_run.h"

#include <string>

namespace bayesian_icp::app {

/** \brief The line of a pair, without a line break. The parts are those of
 * posterior.json; of the covariances, `parameters` and `right_se3`. A pair that could
 * not be registered has status "error" and the same keys. */
std::string
batchLine(const BatchResult& result);

/** \brief What a batch that goes on reads of a line. */
struct FinishedPair {
  std::string name;
  std::string settings_id;
  std::string status;
};

/** \brief Read a line back. \throws std::exception if it is not one */
FinishedPair
readBatchLine(const std::string& line);

} // namespace bayesian_icp::app
