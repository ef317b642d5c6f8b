/** \file
 * \brief The line of JSON that a pair of a batch ends in.
 */
#pragma once

#include "batch/manifest.h"
#include "register/run.h"

#include <string>

namespace bayesian_icp::app {

/** \brief The status of a pair that could not be registered. */
constexpr const char* error_status = "error";

/** \brief The line of a pair that has been registered, without a line break. The parts
 * are those of posterior.json; of the covariances, `parameters` and `right_se3`.
 * \param[in] seconds from reading the clouds to the posterior */
std::string
batchLine(const BatchPair& pair, const Run& run, double seconds);

/** \brief The line of a pair that could not be registered, with the same keys. */
std::string
batchErrorLine(const BatchPair& pair, const std::string& message, double seconds);

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
