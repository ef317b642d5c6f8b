/** \file
 * \brief posterior.json: everything about a run but the draws.
 */
#pragma once

#include "register/run.h"

#include <string>

namespace bayesian_icp::app {

/** \brief The document as text. Lengths are in metres, angles in radians; numbers that
 * are not finite are null. */
std::string
posteriorJson(const Run& run);

} // namespace bayesian_icp::app
