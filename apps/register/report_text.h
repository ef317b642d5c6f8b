/** \file
 * \brief The table that pcl_bayesian_icp prints.
 */
#pragma once

#include "register/run.h"

#include <string>

namespace bayesian_icp::app {

/** \brief Pose, deviation, interval and diagnostics with units, the status in words,
 * and matrices in the form that pcl_transform_point_cloud takes. */
std::string
reportText(const Run& run);

/** \brief "not mixed: the chains ..." */
std::string
statusText(const Summary& summary);

} // namespace bayesian_icp::app
