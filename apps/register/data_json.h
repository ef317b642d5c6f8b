/** \file
 * \brief What the clouds say about the pose, as the "data" of posterior.json.
 */
#pragma once

#include <bayesian_icp/data_report.h>

#include <nlohmann/json_fwd.hpp>

namespace bayesian_icp::app {

/** \brief The report, units in the names of keys; null if there is none. */
nlohmann::ordered_json
dataJson(const DataReport& report);

} // namespace bayesian_icp::app
