/** \file
 * \brief posterior.json: everything about a run but the draws.
 */
#pragma once

#include "register/run.h"

#include <string>

namespace bayesian_icp::app {

/** \brief Name and version of the layout; a change that breaks readers is a new
 * version. */
constexpr const char* posterior_schema_name = "pcl_bayesian_icp/posterior";
constexpr int posterior_schema_version = 1;

/** \brief The document as text. Lengths are in metres, angles in radians; numbers that
 * are not finite are null. */
std::string
posteriorJson(const Run& run);

} // namespace bayesian_icp::app
