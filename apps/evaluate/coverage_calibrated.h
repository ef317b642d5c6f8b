/** \file
 * \brief Preset `calibrated` as methods of the coverage study.
 */
#pragma once

#include "coverage_case.h"

namespace bayesian_icp::evaluate {

/** \brief The calibrated Gaussian; notes are its flags and the number of directions
 * held by the prior only. */
MethodResult
runCalibrated(const CoverageCase& problem);

/** \brief The same and 2000 draws. */
MethodResult
runCalibratedDraws(const CoverageCase& problem);

} // namespace bayesian_icp::evaluate
