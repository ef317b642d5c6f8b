/** \file
 * \brief Preset `calibrated` as methods of the coverage study.
 */
#pragma once

#include "calibrated/calibrated_estimate.h"
#include "study/coverage_case.h"

namespace bayesian_icp::evaluate {

/** \brief The estimate that the methods are made of, from at most 2000 source points.
 */
CalibratedEstimate
calibratedEstimateOf(const CoverageCase& problem);

/** \brief The calibrated Gaussian; notes are its flags and the number of directions
 * held by the prior only. */
MethodResult
runCalibrated(const CoverageCase& problem);

/** \brief What a user gets: 2000 draws of the preset, from all modes, with its status
 * as a flag. */
MethodResult
runCalibratedDraws(const CoverageCase& problem);

} // namespace bayesian_icp::evaluate
