/** \file
 * \brief Registering clouds in units of their size, as the paper's authors' program
 * can.
 */
#pragma once

#include "register/run.h"

namespace bayesian_icp::app {

/** \brief Whether the clouds are to be scaled: preset `paper` alone has a scale of its
 * own, 1 m, that this changes. */
bool
isNormalized(const Settings& settings);

/** \brief As registerClouds(), with both clouds divided by their largest coordinate;
 * the results, and what the callbacks are told, are in metres again. */
RegistrationResult
registerNormalized(const Eigen::Matrix3Xf& source,
                   const Eigen::Matrix3Xf& target,
                   const Settings& settings,
                   const ProgressCallback& progress,
                   const IcpCallback& icp_progress);

} // namespace bayesian_icp::app
